#pragma once
#include <span>
#include <utility>
#include <vector>

#include "sim_server/elasticity/laws.h"
#include "sim_server/elasticity/material.h"
#include "sim_server/elasticity/tensor_products.h"
#include "sim_server/mesh/cut_mesh.h"

namespace palpate::sim {

/// K_ij of a tetrahedron per volume (Pa/m^2), of the gradients g of the shape functions of two corners:
///   lambda g_i g_j^T + mu g_j g_i^T + mu (g_i . g_j) I
/// (Cotin, Delingette and Ayache 2000, equation 12).
inline Mat3 stiffness_per_volume(const Moduli& moduli, const Vec3& gi, const Vec3& gj) {
  return LinearLaw(moduli, Mat3::Identity()).block(0, gi, gj) + moduli.lambda * gi * gj.transpose();
}

/// The stiffness K of linear tetrahedra over the free vertices, as tensors (Cotin, Delingette and Ayache
/// 2000, Vis. Comput. 16:437): a symmetric one for each vertex, K_ii, and one for each edge, K_ij, kept once
/// and used for both of its ends. Of a tetrahedron of volume V whose shape functions have gradients g (their
/// equation 12): K_ij = V `stiffness_per_volume`, K_ji = K_ij^T.
/// Vertices are numbered along a space-filling curve, so that what meets lies close together in memory: 76
/// bytes an edge and 52 a vertex, about 100 a tetrahedron; 8 and 4 more in parts. A product takes 0.20 to
/// 0.27 of the time of Eigen's with the same sparse matrix by rows, 0.33 to 0.37 of that with its lower
/// triangle, and for eight vectors 0.24 to 0.34 of that by rows (`scripts/bench --quick '^tensors'`, 3 to 105
/// thousand tetrahedra).
class ElasticTensors {
 public:
  /// O(m log m). Summed in tetrahedron order, so the same mesh gives the same bits. `mass_factors`: of the
  /// mass of each tetrahedron; empty: all 1.
  ElasticTensors(const TetMesh& mesh, const Material& material, const std::vector<int>& fixed,
                 std::vector<double> mass_factors = {});

  /// After these tetrahedra have been removed: sums the tensors and masses at their vertices and edges anew,
  /// over what is left around them, in the order of the constructor, so that they have the bits that a fresh
  /// assembly of what is left has. Where nothing is left they are 0, but for the mass, which stays as it was.
  /// O(removed), whatever the size of the mesh: some 20 us each.
  void remove(std::span<const int> removed, const CutMesh& remaining, const Material& material);

  /// After faces have been parted: the copies of vertices have places after all others, with the edges that
  /// they have now, and what is around tetrahedra that have other corners, or whose shape at rest has changed
  /// (`reshaped`), is summed anew, as by `remove`. O(changed), but for room.
  void part(const Parting& parting, std::span<const int> reshaped, const CutMesh& remaining,
            const Material& material);

  /// Sets the mass factor of a tetrahedron, from its next summation on.
  void set_mass_factor(int tetrahedron, double factor) {
    if (mass_factors_.empty()) return;
    mass_factors_[static_cast<std::size_t>(tetrahedron)] = factor;
  }

  /// Returns the mass factor of each tetrahedron; empty: all 1.
  const std::vector<double>& mass_factors() const { return mass_factors_; }

  /// Adds a mass (kg, >= 0) to the vertex at this place, beyond the mass of its tetrahedra.
  void add_mass(int place, double kg);

  /// Number of vectors that `multiply_wide` takes at once.
  static constexpr int kWide = 8;
  /// Stride of the vertices in the vectors of a product in parts; the last number of each is unused.
  static constexpr int kNumbersPerVertex = kNumbersPerVertex_;
  /// Sums that parts of a product add to rows of earlier parts: for each part, and 0 between two products.
  using Ahead = std::vector<std::vector<double>>;
  Ahead room_ahead() const;
  /// y = K x: forces (n x 3, N) of displacements (n x 3, m), n = `vertices()`.
  void multiply(const double* x, double* y) const noexcept;
  /// Multiplies vectors of n x `kNumbersPerVertex`, of 40 thousand edges or more in 8 or 16 parts, on as many
  /// cores. The tensors alone decide the number of parts. Call `multiply_part` of each, then `gather_part` of
  /// each, after which the rows of that part are done. Returns equal bits whatever the number of threads. A
  /// caller that uses a part's rows on the core that made them has them in its cache.
  std::size_t parts() const { return parts_.size(); }
  std::pair<int, int> rows_of_part(std::size_t p) const { return {parts_[p].begin, end_of_part(p)}; }
  void multiply_part(std::size_t p, const double* x, double* y, Ahead& ahead) const noexcept;
  void gather_part(std::size_t p, double* y, Ahead& ahead) const noexcept;
  /// y += K x, of an x that is 0 but at this place; y of n x `kNumbersPerVertex`. For tensors of more than
  /// one part. O(edges there).
  void add_product(int place, const Vec3& x, double* y) const noexcept;
  /// Multiplies eight vectors side by side (n x 3 x 8, with the eight entries of a component together), at
  /// about half of the time for each: tensors are read once.
  void multiply_wide(const double* x, double* y) const noexcept;

  /// Returns the place of each mesh vertex among the free ones, or -1.
  const std::vector<int>& places() const { return place_; }
  /// Lumped mass of each free vertex: a quarter of that of each tetrahedron around it, and what was added,
  /// kg.
  const std::vector<double>& masses() const { return mass_; }
  int vertices() const { return static_cast<int>(mass_.size()); }
  int edges() const { return static_cast<int>(neighbour_.size()); }
  /// Returns the memory of the tensors and their indices: what a product reads, but for the vectors.
  std::size_t bytes() const;

 private:
  void number(const TetMesh& mesh, const std::vector<int>& fixed);
  void find_edges(const TetMesh& mesh);
  template <class Wanted>
  void add(const TetMesh& mesh, std::size_t tetrahedron, const Material& material, const Wanted& wanted);
  double* edge_tensor(int i, int j);
  /// Places of the ends of edges, the later first; of a vertex twice the same.
  using Touched = std::vector<std::pair<int, int>>;
  void note_touched(const Tetrahedron& corners, Touched& touched) const;
  void sum_anew(Touched& touched, std::vector<int>& around, const CutMesh& remaining,
                const Material& material);
  void append(int vertex, const CutMesh& remaining);
  void distribute();
  void find_later_edges();
  /// Rows that one thread does of a product.
  struct Part {
    int begin;
    std::vector<int> reaches;  // rows before them that it adds to
  };
  int end_of_part(std::size_t p) const { return p + 1 < parts_.size() ? parts_[p + 1].begin : vertices(); }

  std::vector<int> place_;
  std::vector<double> mass_factors_;  // of tetrahedra, or empty
  std::vector<double> mass_;
  std::vector<double> added_;           // of `mass_`, by `add_mass`; or empty
  std::vector<double> vertex_tensors_;  // xx xy xz yy yz zz
  // Of vertex i, those to neighbours before it: from first_edge_[i] to first_edge_[i + 1].
  std::vector<int> first_edge_, neighbour_;
  std::vector<double> edge_tensors_;  // row by row
  // Of more than one part: of vertex i, the edges to neighbours after it, from first_later_[i] to [i + 1].
  struct LaterEdge {
    int row, edge;
  };
  std::vector<int> first_later_;
  std::vector<LaterEdge> later_edges_;
  std::vector<Part> parts_;
};

}  // namespace palpate::sim
