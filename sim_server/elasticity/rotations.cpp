#include "sim_server/elasticity/rotations.h"

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace palpate::sim {
namespace {

constexpr int kMostTurns = 20;     // of random matrices with stretches from 1e-3 to 1 none took over 6
constexpr double kTurned = 1e-14;  // square of what the last turn changed
constexpr double kNear = 0.01;     // square of such a change: from here on it converges as fast unscaled
constexpr double kFlat = 1e-3;     // of the cube of its size: too flat for Newton

#define PALPATE_INLINE [[gnu::always_inline]] inline

/// One number of each of several matrices; operators work on all. `Mask`: where a comparison holds.
template <std::size_t lanes>
struct Lanes;
template <>
struct Lanes<2> {
  typedef double Real __attribute__((vector_size(16)));
  typedef std::int64_t Mask __attribute__((vector_size(16)));
};
template <>
struct Lanes<4> {
  typedef double Real __attribute__((vector_size(32)));
  typedef std::int64_t Mask __attribute__((vector_size(32)));
};

template <std::size_t lanes>
PALPATE_INLINE bool any(const typename Lanes<lanes>::Mask& mask) noexcept {
  bool some = false;
  for (std::size_t i = 0; i < lanes; ++i) some |= mask[i] != 0;
  return some;
}

template <std::size_t lanes>
PALPATE_INLINE void take_roots(typename Lanes<lanes>::Real& x) noexcept {
  for (std::size_t i = 0; i < lanes; ++i) x[i] = std::sqrt(x[i]);
}

/// Several 3 x 3 matrices, entries by columns.
template <std::size_t lanes>
struct Matrices {
  using Real = typename Lanes<lanes>::Real;
  std::array<Real, 9> at;

  PALPATE_INLINE void squared_norm(Real& sum) const noexcept {
    sum = at[0] * at[0];
    for (std::size_t k = 1; k < 9; ++k) sum += at[k] * at[k];
  }
  PALPATE_INLINE void determinant(const Matrices& cofactors, Real& det) const noexcept {
    det = at[0] * cofactors.at[0] + at[1] * cofactors.at[1] + at[2] * cofactors.at[2];
  }
  PALPATE_INLINE void cofactors(Matrices& c) const noexcept {
    for (std::size_t column = 0; column < 3; ++column) {
      const Real *const a = at.data() + (column + 1) % 3 * 3, *const b = at.data() + (column + 2) % 3 * 3;
      c.at[3 * column] = a[1] * b[2] - a[2] * b[1];
      c.at[3 * column + 1] = a[2] * b[0] - a[0] * b[2];
      c.at[3 * column + 2] = a[0] * b[1] - a[1] * b[0];
    }
  }
};

Mat3 rotation_by_singular_values(const Mat3& F) noexcept {
  const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vec3 signs(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant());
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

/// Scaled so that Newton's method converges in a few steps from far away, too (Higham, equation 3.5); where
/// it is near, one.
template <std::size_t lanes, class Real = typename Lanes<lanes>::Real>
PALPATE_INLINE void find_scale(const Matrices<lanes>& R, const Matrices<lanes>& c, const Real& det,
                               const Real& change, Real& scale) noexcept {
  const Real one = Real() + 1;
  scale = one;
  if (!any<lanes>(change > kNear)) return;
  Real size, inverse;
  R.squared_norm(size);
  c.squared_norm(inverse);
  Real ratio = inverse / size;
  take_roots<lanes>(ratio);
  ratio /= det;
  take_roots<lanes>(ratio);
  scale = change > kNear ? ratio : one;
}

/// Turns each of `R` that `wanted` tells into the rotation nearest to it.
template <std::size_t lanes>
PALPATE_INLINE void turn(Matrices<lanes>& R, const typename Lanes<lanes>::Mask& wanted) noexcept {
  using Real = typename Lanes<lanes>::Real;
  Real change = wanted ? Real() + 3 : Real();
  for (int i = 0; i < kMostTurns && any<lanes>(change > kTurned); ++i) {
    Matrices<lanes> c;
    Real det, scale;
    R.cofactors(c);
    R.determinant(c, det);
    find_scale<lanes>(R, c, det, change, scale);
    const Real stored = 0.5 * scale, added = 0.5 / (scale * det);
    const typename Lanes<lanes>::Mask turns = change > kTurned;
    Real sum = Real();
    for (std::size_t k = 0; k < 9; ++k) {
      const Real next = stored * R.at[k] + added * c.at[k], step = next - R.at[k];
      sum += step * step;
      R.at[k] = turns ? next : R.at[k];
    }
    change = turns ? sum : Real();
  }
}

/// Turns as many as there are lanes.
template <std::size_t lanes>
PALPATE_INLINE void rotations(const Mat3* F, Mat3* R) noexcept {
  Matrices<lanes> m, c;
  for (std::size_t k = 0; k < 9; ++k) {
    for (std::size_t i = 0; i < lanes; ++i) m.at[k][i] = F[i].data()[k];
  }
  typename Lanes<lanes>::Real size, det;
  m.squared_norm(size);
  size /= 3;
  take_roots<lanes>(size);
  m.cofactors(c);
  m.determinant(c, det);
  const typename Lanes<lanes>::Mask fit = det > kFlat * size * size * size;
  for (auto& entry : m.at) entry = fit ? entry / size : entry;
  turn<lanes>(m, fit);
  for (std::size_t i = 0; i < lanes; ++i) {
    if (fit[i] == 0) {
      R[i] = rotation_by_singular_values(F[i]);
      continue;
    }
    for (std::size_t k = 0; k < 9; ++k) R[i].data()[k] = m.at[k][i];
  }
}

constexpr std::size_t kBatch = 4;  // doubles in a register of AVX2

/// The same bits, whatever the processor.
void rotate_batch(const Mat3* F, Mat3* R) noexcept {
  for (std::size_t i = 0; i < kBatch; i += 2) rotations<2>(F + i, R + i);
}
#ifdef __x86_64__
__attribute__((target("avx2"))) void rotate_batch_avx2(const Mat3* F, Mat3* R) noexcept {
  rotations<4>(F, R);
}
const auto rotate = __builtin_cpu_supports("avx2") ? &rotate_batch_avx2 : &rotate_batch;
#else
constexpr auto rotate = &rotate_batch;
#endif

}  // namespace

void nearest_rotations(std::span<const Mat3> F, std::span<Mat3> R) noexcept {
  std::size_t done = 0;
  for (; done + kBatch <= F.size(); done += kBatch) rotate(F.data() + done, R.data() + done);
  if (done == F.size()) return;
  std::array<Mat3, kBatch> last, turned;
  for (std::size_t i = 0; i < kBatch; ++i) last[i] = F[std::min(done + i, F.size() - 1)];
  rotate(last.data(), turned.data());
  std::copy_n(turned.begin(), F.size() - done, R.begin() + static_cast<std::ptrdiff_t>(done));
}

Mat3 nearest_rotation(const Mat3& F) noexcept {
  Mat3 R;
  nearest_rotations({&F, 1}, {&R, 1});
  return R;
}

}  // namespace palpate::sim
