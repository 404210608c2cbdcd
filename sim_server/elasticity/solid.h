#pragma once
#include <functional>
#include <span>
#include <vector>

#include "sim_server/elasticity/floating_pieces.h"
#include "sim_server/elasticity/laws.h"
#include "sim_server/elasticity/material.h"
#include "sim_server/mesh/tet_mesh.h"
#include "sim_server/sparse/stiffness_matrix.h"

namespace palpate::sim {

/// The mesh with the nodes of such elements among its vertices: quadratic ones have them on edges too.
TetMesh with_nodes(TetMesh mesh, ElementKind element);

/// Viscous part of the stress at each quadrature point. The present stress counts `scale` times. `memory`
/// (second Piola-Kirchhoff; Cauchy of the linear law; Pa) is the stress of earlier strains that has not
/// relaxed yet.
struct Viscosity {
  double scale = 1;
  std::span<const Mat3> memory = {};  ///< (points), or empty: none
};

/// A body of tetrahedra and one material: energy, internal forces and tangent stiffness of a deformed state.
/// Three elements:
/// - `kLinear`: four nodes, one quadrature point. Locks where nu goes to one half.
/// - `kNodalPressure`: the same, with the dilation averaged over the tetrahedra around each vertex and the
///   volume energy counted there (Bonet and Burton 1998, Commun. Numer. Meth. Engng 14:437, whose pressure it
///   is; here from one energy, so that forces are conservative and the stiffness symmetric):
///     theta_a = sum_e V_e / 4 theta_e / V_a,   E_vol = sum_a V_a lambda / 2 theta_a^2.
/// - `kQuadratic`: ten nodes, straight edges with one more node in the middle of each, four points
/// (Zienkiewicz
///   and Taylor 2000, volume 1, tables 8.5 and 9.3).
/// Sums run over tetrahedra in their order, whatever the number of threads: the same bytes. A body does not
/// change after its construction but by `remove` and `reshape`; what a call writes to is the caller's
/// `Scratch`, so that several threads may ask at once, each with its own. Calls without one make their own,
/// which suits set-up and tests.
class Solid {
 public:
  class Scratch;

  /// Throws `Error` where `mesh` is not as `with_nodes` makes it for this material.
  Solid(const TetMesh& mesh, const Material& material);

  /// The vertices of the mesh, in its order.
  int nodes() const { return static_cast<int>(rest_.size()); }
  const std::vector<Vec3>& rest() const { return rest_; }
  const Material& material() const { return material_; }

  /// Elastic energy at positions `x` (nodes, m), J; without viscosity.
  double energy(std::span<const Vec3> x, Scratch& scratch) const;
  double energy(std::span<const Vec3> x) const;
  /// Forces (nodes, N) with which the body resists being at `x`: dE/dx.
  void forces(std::span<const Vec3> x, std::span<Vec3> f, const Viscosity& viscosity, Scratch& scratch) const;
  void forces(std::span<const Vec3> x, std::span<Vec3> f, const Viscosity& viscosity = {}) const;
  /// Adds the derivative of `forces` to `k`.
  void add_stiffness(std::span<const Vec3> x, StiffnessMatrix& k, const Viscosity& viscosity,
                     Scratch& scratch) const;
  void add_stiffness(std::span<const Vec3> x, StiffnessMatrix& k, const Viscosity& viscosity = {}) const;
  /// A block of it: the derivative of the force on node i by the place of node j, N/m.
  using TakeBlock = std::function<void(int i, int j, const Mat3& block)>;
  /// Visits the blocks of one tetrahedron, each pair of its nodes once. Not of averaged dilation.
  void stiffness_of(std::size_t e, std::span<const Vec3> x, const Viscosity& viscosity, Scratch& scratch,
                    const TakeBlock& take) const;
  /// A matrix with room for it.
  StiffnessMatrix stiffness_matrix(const FreeDofs& dofs) const;
  /// Adds the forces (nodes, N) of a force per volume (N/m^3), as the shape functions say.
  void add_body_forces(const Vec3& per_volume, std::span<Vec3> f) const;
  /// Computes the rotation of each node at positions `x` (nodes, m): the rotation nearest to the mean of the
  /// deformation gradients around it, by volume; of the linear law that of its floating piece, or none.
  /// O(elements); allocates.
  void node_rotations(std::span<const Vec3> x, std::span<Mat3> rotations) const;
  /// Lumped mass of each node, kg: a quarter of a tetrahedron for each vertex; of ten nodes 1/36 for a corner
  /// and 4/27 for the middle of an edge (Hinton, Rock and Zienkiewicz 1976).
  std::vector<double> masses() const;

  /// Tetrahedron e is no more: from now on it has no volume, and resists nothing. Not of averaged dilation.
  void remove(std::size_t e);
  /// Updates these tetrahedra to their corners in `mesh`, and to their rest positions there: other corners
  /// than before, of equal number, or moved ones. Of linear elements.
  void reshape(const TetMesh& mesh, std::span<const int> tetrahedra);
  /// Lets these parts (tetrahedra of each) float, all else is held: the linear law acts in the frame of each
  /// (`FloatingPieces`). Other laws know turns, and ignore this. O(elements).
  void release(std::span<const std::vector<int>> parts);
  /// True if the stiffness turns with the body: not of the linear law, but in floating pieces.
  bool turns() const { return material_.law != ElasticLaw::kLinear || !floating_.empty(); }
  bool is_removed(std::size_t e) const { return weight_[e * static_cast<std::size_t>(points_)] == 0; }
  /// Elastic energy of one tetrahedron, J.
  double energy_of(std::size_t e, std::span<const Vec3> x) const;

  /// Nodes of tetrahedron e, 4 or 10: corners, then the middles of its edges in the order of `kEdges`.
  std::span<const int> element(std::size_t e) const {
    return std::span(element_nodes_)
        .subspan(e * static_cast<std::size_t>(corners_), static_cast<std::size_t>(corners_));
  }
  std::size_t elements() const { return element_nodes_.size() / static_cast<std::size_t>(corners_); }
  /// Quadrature points in all: of tetrahedron e from e * points_per_element().
  std::size_t points() const { return weight_.size(); }
  int points_per_element() const { return points_; }
  double volume_of(std::size_t point) const { return weight_[point] / stiffness_of(point); }
  /// Returns the stiffness factor of the tissue at this point, as a multiple of the material: all stresses
  /// and energies scale with it.
  double stiffness_of(std::size_t point) const {
    return stiffness_.empty() ? 1 : stiffness_[point / static_cast<std::size_t>(points_)];
  }
  /// First Piola-Kirchhoff stress (Pa) and deformation gradient at each point, and the energy density
  /// (J/m^3), of the material: where the tissue is stiffer, to be multiplied by `stiffness_of`.
  struct State {
    Mat3 F, stress;
    double energy;
  };
  /// The energy is the law's at once, whatever has relaxed.
  void evaluate(std::span<const Vec3> x, std::span<State> at_points, const Viscosity& viscosity,
                Scratch& scratch) const;
  void evaluate(std::span<const Vec3> x, std::span<State> at_points, const Viscosity& viscosity = {}) const;
  /// Without any scratch.
  std::size_t bytes() const;

 private:
  struct Element;
  bool averages() const { return material_.element == ElementKind::kNodalPressure; }
  void build_linear(const TetMesh& mesh);
  void build_quadratic(const TetMesh& mesh);
  void gather_patches();
  void average_dilation(std::span<const Vec3> x, Scratch& scratch) const;
  FibreLaw fibre_law(const Mat3& F) const;
  template <class Law, class Work>
  void each_element(std::span<const Vec3> x, std::size_t begin, std::size_t end, const Work& work) const;
  template <class Law>
  void element_forces(const Element& element, const Mat3* F, const Mat3* R, Vec3* f,
                      const Viscosity& viscosity, const Scratch& scratch) const;
  template <class Law>
  void element_stiffness(const Element& element, const Mat3* F, const Mat3* R, Mat3* k,
                         const Viscosity& viscosity, const Scratch& scratch) const;
  void add_extras(const Element& element, int q, const Mat3& F, const Viscosity& viscosity, Mat3* k) const;
  void add_nodal_stiffness(std::span<const Vec3> x, StiffnessMatrix& k, double scale) const;
  void collect_terms(std::size_t a, std::span<const Vec3> along,
                     std::vector<std::pair<int, Vec3>>& terms) const;
  void sum_forces(std::span<const Vec3> x, std::span<Vec3> f, const Viscosity& viscosity,
                  Scratch& scratch) const;
  class TurnedBack;

  Material material_;
  int corners_ = 4, points_ = 1;  // nodes and quadrature points of an element
  std::vector<Vec3> rest_;
  std::vector<int> element_nodes_;  // (elements x corners)
  std::vector<double> weight_;      // (points in all), volume x stiffness, m^3
  std::vector<double> stiffness_;   // (elements), or empty: all 1
  std::vector<Vec3> gradient_;      // (points in all x corners), 1/m
  // Only for averaged dilation: the tetrahedra around each vertex, and its share of their volume.
  std::vector<int> around_, around_first_;
  std::vector<double> nodal_volume_;
  FloatingPieces floating_;  // only of the linear law
};

/// Work memory of `Solid`: made once for a body and a thread, it saves each call the allocation.
class Solid::Scratch {
 public:
  explicit Scratch(const Solid& solid);
  std::size_t bytes() const;

 private:
  friend class Solid;
  /// Mean over the four vertices of a tetrahedron, which sets the averaged pressure in it.
  double mean_dilation(const int* nodes) const;

  std::vector<double> dilation_, nodal_dilation_;  // only averaged: of each element, and of each vertex
  std::vector<Vec3> forces_;                       // of a batch of elements, (elements x corners) N
  std::vector<Mat3> blocks_;                       // of their stiffness, the lower triangles, N/m
};

}  // namespace palpate::sim
