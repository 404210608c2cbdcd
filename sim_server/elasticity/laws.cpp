#include "sim_server/elasticity/laws.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace palpate::sim {
namespace {

constexpr double kLeastStretch = 0.1;  // sum of two stretches below which R turns no faster

Mat3 cross_matrix(const Vec3& a) noexcept {
  Mat3 m;
  m << 0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0;
  return m;
}

[[gnu::always_inline]] inline Mat3 cofactor(const Mat3& F) noexcept {
  Mat3 c;
  c << F.col(1).cross(F.col(2)), F.col(2).cross(F.col(0)), F.col(0).cross(F.col(1));
  return c;
}

}  // namespace

void CorotationalLaw::prepare_blocks() noexcept {
  Mat3 stretch = F_ * R_.transpose();  // R S R^T
  stretch = 0.5 * (stretch + stretch.transpose()).eval();
  Mat3 sums = -stretch;  // its eigenvalues are the sums of two stretches
  sums.diagonal().array() += trace_;
  const double det = sums.determinant(), size = sums.norm();
  if (det > kLeastStretch * size * size / 4) {
    turn_ = sums.inverse();
    return;
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(sums);
  const Vec3 inverse = eigen.eigenvalues().cwiseAbs().cwiseMax(kLeastStretch).cwiseInverse();
  turn_ = eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

Mat3 CorotationalLaw::block(double p, const Vec3& gi, const Vec3& gj) const noexcept {
  const Mat3 qi = cross_matrix(R_ * gi), qj = cross_matrix(R_ * gj);
  Mat3 block = (2 * mu_ - p) * qi * turn_ * qj;  // qj is skew: its transpose is -qj
  block.diagonal().array() += 2 * mu_ * gi.dot(gj);
  return block;
}

Mat3 StVenantKirchhoffLaw::block(double p, const Vec3& gi, const Vec3& gj) const noexcept {
  const double product = gi.dot(gj);
  Mat3 block = mu_ * (product * F_ * F_.transpose() + (F_ * gj) * (F_ * gi).transpose());
  block.diagonal().array() += 2 * mu_ * gi.dot(strain_ * gj) + p * product;
  return block;
}

NeoHookeanLaw::NeoHookeanLaw(const Moduli& moduli, const Mat3& F) noexcept
    : mu_(moduli.mu), stretch2_(F.squaredNorm()), F_(F), cofactor_(cofactor(F)) {
  volume_ = F.col(0).dot(cofactor_.col(0));
}

double NeoHookeanLaw::shape_energy() const noexcept {
  return 0.5 * mu_ * (stretch2_ - 3 - std::log((stretch2_ + 1) / 4)) - 0.75 * mu_ * (volume_ - 1);
}

Mat3 NeoHookeanLaw::block(double p, const Vec3& gi, const Vec3& gj) const noexcept {
  const double shrink = 1 / (stretch2_ + 1);
  Mat3 block = 2 * mu_ * shrink * shrink * (F_ * gi) * (F_ * gj).transpose();
  block.diagonal().array() += mu_ * (1 - shrink) * gi.dot(gj);
  // The second derivative of det F along a gi^T and b gj^T is (a x b) . F (gi x gj).
  block -= (p - 0.75 * mu_) * cross_matrix(F_ * gi.cross(gj));
  return block;
}

FibreLaw::FibreLaw(double modulus, const Vec3& a, const Mat3& F, bool small_strain) noexcept
    : k_(modulus), a_(a), along_(a) {
  const Vec3 now = F * a;
  if (small_strain) {
    stretch_ = a.dot(now) - 1;
    return;
  }
  const double length = now.norm();
  stretch_ = length - 1;
  if (!(length > 0)) return;
  along_ = now / length;
  across_ = stretch_ / length;
}

Mat3 FibreLaw::block(const Vec3& gi, const Vec3& gj) const noexcept {
  Mat3 block = (1 - across_) * along_ * along_.transpose();
  block.diagonal().array() += across_;
  return k_ * gi.dot(a_) * gj.dot(a_) * block;
}

}  // namespace palpate::sim
