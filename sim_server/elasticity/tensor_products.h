#pragma once

namespace palpate::sim {

/// The tensors of `ElasticTensors` (N/m), and where they belong: of row i the edges `first_edge[i]` to
/// `first_edge[i + 1]`, with the rows of their other ends in `neighbour`, which come before it, ascending.
/// Six numbers a vertex, nine an edge; one more can be read beyond the last edge.
struct TensorsInPlace {
  const int *first_edge, *neighbour;
  const double *vertex, *edge;
};

/// Stride of the vertices of a vector that is read and written at full width: three numbers of the vertex,
/// one unused.
constexpr int kNumbersPerVertex_ = 4;

/// y = K x (n x 3, m and N), rows `begin` to `end`: what they add to rows before `begin` is added to those of
/// `ahead`, which may be null where `begin` is 0. One thread; O(edges). Any processor gives the same bits.
void product_of_rows(int begin, int end, const TensorsInPlace& k, const double* x, double* y,
                     double* ahead) noexcept;
/// Computes that product for vectors (n x `kNumbersPerVertex_`) of which the fourth number of each vertex is
/// unused, of any value. Same bits in nine tenths of the time, as each vertex is one load and one store.
void product_of_separate_rows(int begin, int end, const TensorsInPlace& k, const double* x, double* y,
                              double* ahead) noexcept;

/// y = K x of all n rows for eight vectors side by side (n x 3 x 8). Otherwise the same.
void product_of_eight(int n, const TensorsInPlace& k, const double* x, double* y) noexcept;

}  // namespace palpate::sim
