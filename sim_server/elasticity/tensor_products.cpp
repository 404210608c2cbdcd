#include "sim_server/elasticity/tensor_products.h"

#include <cstddef>
#include <cstring>

namespace palpate::sim {
namespace {

// Numbers, of 32 edges: tensors are read once, in order, and are more than the nearest cache holds.
constexpr int kFetchAhead = 288;

/// Four numbers side by side, of which three are used.
using Four [[gnu::vector_size(32)]] = double;
using Two [[gnu::vector_size(16)]] = double;
template <class Numbers>
[[gnu::always_inline]] inline void load(const double* from, Numbers& to) {
  std::memcpy(&to, from, sizeof to);
}

/// Adds the first three of four numbers to those of a vertex; where vertices are four apart, all.
template <int kStride>
[[gnu::always_inline]] inline void add_to_vertex(const Four& more, double* __restrict to) {
  if constexpr (kStride == 4) {
    Four entire;
    load(to, entire);
    entire += more;
    std::memcpy(to, &entire, sizeof entire);
  } else {
    Two two;  // as it was written: else the processor waits
    load(to, two);
    two += Two{more[0], more[1]};
    std::memcpy(to, &two, sizeof two);
    to[2] += more[2];
  }
}

/// y = K x of one vector, vertices `kStride` numbers apart, rows `begin` to `end`. Row i also adds to the
/// rows of its neighbours, which come before it: to `ahead` where they come before `begin`. Each line of a
/// tensor meets both ends of its edge as it was read: the own row is summed along the lines, lane by lane,
/// and across the lanes once a vertex. Reads one number beyond the tensors of edges. Any vector width gives
/// the same bits.
template <int kStride>
[[gnu::always_inline]] inline void product_of_one(int begin, int end, const TensorsInPlace& k,
                                                  const double* __restrict x, double* __restrict y,
                                                  double* __restrict ahead) {
  const double* __restrict edge = k.edge + 9 * std::ptrdiff_t{k.first_edge[begin]};
  const double* __restrict vertex = k.vertex + 6 * std::ptrdiff_t{begin};
  for (int i = begin; i < end; ++i, vertex += 6) {
    const double* const xi = x + std::ptrdiff_t{kStride} * i;
    const double a = xi[0], b = xi[1], d = xi[2];
    Four px{}, py{}, pz{};
    const auto add_product = [&](int other, double* __restrict to) __attribute__((always_inline)) {
      const std::ptrdiff_t j = std::ptrdiff_t{kStride} * other;
      Four xj, along_x, along_y, along_z;
      load(x + j, xj);
      load(edge, along_x);
      load(edge + 3, along_y);
      load(edge + 6, along_z);
      __builtin_prefetch(edge + kFetchAhead);
      px += along_x * xj;
      py += along_y * xj;
      pz += along_z * xj;
      add_to_vertex<kStride>(along_x * a + along_y * b + along_z * d, to + j);
      edge += 9;
    };
    int e = k.first_edge[i];
    const int last = k.first_edge[i + 1];
    for (; e < last && k.neighbour[e] < begin; ++e) add_product(k.neighbour[e], ahead);
    for (; e < last; ++e) add_product(k.neighbour[e], y);
    double* yi = y + std::ptrdiff_t{kStride} * i;
    yi[0] = vertex[0] * a + vertex[1] * b + vertex[2] * d + (px[0] + px[1] + px[2]);
    yi[1] = vertex[1] * a + vertex[3] * b + vertex[4] * d + (py[0] + py[1] + py[2]);
    yi[2] = vertex[2] * a + vertex[4] * b + vertex[5] * d + (pz[0] + pz[1] + pz[2]);
    if constexpr (kStride == 4) yi[3] = 0;
  }
}

/// y = K x for `kColumns` vectors side by side. Row i also adds to the rows of its neighbours, which come
/// before it. Lanes do not meet: any vector width gives the same bits.
template <int kColumns>
[[gnu::always_inline]] inline void product(int n, const int* __restrict first_edge,
                                           const int* __restrict neighbour, const double* __restrict vertex,
                                           const double* __restrict edge, const double* __restrict x,
                                           double* __restrict y) {
  constexpr int kRow = 3 * kColumns;  // numbers of a vertex
  for (int i = 0; i < n; ++i, vertex += 6) {
    const double* xi = x + std::ptrdiff_t{kRow} * i;
    double px[kColumns], py[kColumns], pz[kColumns];
    for (int c = 0; c < kColumns; ++c) {
      const double a = xi[c], b = xi[kColumns + c], d = xi[2 * kColumns + c];
      px[c] = vertex[0] * a + vertex[1] * b + vertex[2] * d;
      py[c] = vertex[1] * a + vertex[3] * b + vertex[4] * d;
      pz[c] = vertex[2] * a + vertex[4] * b + vertex[5] * d;
    }
    for (int e = first_edge[i]; e < first_edge[i + 1]; ++e, edge += 9) {
      const double* xj = x + std::ptrdiff_t{kRow} * neighbour[e];
      double* __restrict yj = y + std::ptrdiff_t{kRow} * neighbour[e];
      for (int c = 0; c < kColumns; ++c) {
        const double a = xi[c], b = xi[kColumns + c], d = xi[2 * kColumns + c];
        const double p = xj[c], q = xj[kColumns + c], r = xj[2 * kColumns + c];
        px[c] += edge[0] * p + edge[1] * q + edge[2] * r;
        py[c] += edge[3] * p + edge[4] * q + edge[5] * r;
        pz[c] += edge[6] * p + edge[7] * q + edge[8] * r;
        yj[c] += edge[0] * a + edge[3] * b + edge[6] * d;
        yj[kColumns + c] += edge[1] * a + edge[4] * b + edge[7] * d;
        yj[2 * kColumns + c] += edge[2] * a + edge[5] * b + edge[8] * d;
      }
    }
    double* __restrict yi = y + std::ptrdiff_t{kRow} * i;
    for (int c = 0; c < kColumns; ++c) {
      yi[c] = px[c];
      yi[kColumns + c] = py[c];
      yi[2 * kColumns + c] = pz[c];
    }
  }
}

#ifdef __x86_64__
/// Twice as fast as with the vectors that every such processor has.
[[gnu::target("avx2")]] void product_avx2(int n, const int* __restrict first_edge,
                                          const int* __restrict neighbour, const double* __restrict vertex,
                                          const double* __restrict edge, const double* __restrict x,
                                          double* __restrict y) {
  product<8>(n, first_edge, neighbour, vertex, edge, x, y);
}
template <int kStride>
[[gnu::target("avx2")]] void product_of_one_avx2(int begin, int end, const TensorsInPlace& k,
                                                 const double* __restrict x, double* __restrict y,
                                                 double* __restrict ahead) {
  product_of_one<kStride>(begin, end, k, x, y, ahead);
}
#endif

template <int kStride>
void product_on_this_processor(int begin, int end, const TensorsInPlace& k, const double* x, double* y,
                               double* ahead) {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2")) return product_of_one_avx2<kStride>(begin, end, k, x, y, ahead);
#endif
  product_of_one<kStride>(begin, end, k, x, y, ahead);
}

}  // namespace

void product_of_rows(int begin, int end, const TensorsInPlace& k, const double* x, double* y,
                     double* ahead) noexcept {
  product_on_this_processor<3>(begin, end, k, x, y, ahead);
}

void product_of_separate_rows(int begin, int end, const TensorsInPlace& k, const double* x, double* y,
                              double* ahead) noexcept {
  product_on_this_processor<kNumbersPerVertex_>(begin, end, k, x, y, ahead);
}

void product_of_eight(int n, const TensorsInPlace& k, const double* x, double* y) noexcept {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2"))
    return product_avx2(n, k.first_edge, k.neighbour, k.vertex, k.edge, x, y);
#endif
  product<8>(n, k.first_edge, k.neighbour, k.vertex, k.edge, x, y);
}

}  // namespace palpate::sim
