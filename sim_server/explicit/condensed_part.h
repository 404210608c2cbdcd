#pragma once
#include <Eigen/Core>
#include <limits>
#include <span>
#include <vector>

#include "sim_server/elasticity/floating_pieces.h"
#include "sim_server/sparse/stiffness_matrix.h"
#include "sim_server/tissue/deformation_model.h"
#include "sim_server/tissue/model_inputs.h"
#include "sim_server/tissue/rayleigh_damping.h"

namespace palpate::sim {

class ElasticTensors;

struct LinearStatics;

/// Condensed part of a linear tissue beside a part in motion. Its slowest modes swing; all other modes are in
/// equilibrium at every instant, under the border to the part in motion and under the loads of tools.
/// Condensed to the vertices of that border, b, and to the surface that tools reach, s (Guyan 1965, AIAA J.
/// 3:380; with modes of the body whose border is held, as Craig and Bampton 1968, AIAA J. 6:1313, but coupled
/// by stiffness, so that masses stay lumped). With K of the whole body, r its vertices that are condensed, u
/// displacements, f forces, and phi the modes of K_rr (unit mass, frequencies w), whose amplitudes p = phi^T
/// M u_r go by
///   p'' + w^2 p = C u_b + phi_s^T f_s,   C = -phi^T K_rb:
///   force on the border where r stays at rest:  -K_bb u_b, which the tensors of the part in motion have;
///   what r adds to it:        B u_b + C^T p + T^T f_s,   B = K_br K_rr^-1 K_rb - C^T w^-2 C  (3b x 3b);
///   where the surface is:     T u_b + phi_s p + W f_s,   T = -(K_rr^-1 K_rb)_s - phi_s w^-2 C,
///                                                        W = (K_rr^-1)_ss - phi_s w^-2 phi_s^T.
/// What of r no mode moves has its mass at the border: as much in all as it has where the border goes as one
/// piece (Guyan's mass matrix, less that of the modes, lumped), shared as the tetrahedra there are.
/// At rest that is the answer of the whole body. Rayleigh damping is that of the part in motion. Parts of r
/// that meet only through the border have matrices of their own. A part that floats is all of this in the
/// frame of its piece (`FloatingPieces`), without modes: all its mass is at the border. One thread; only the
/// constructor allocates and throws. Bytes: 72 b^2 + 72 b s + 72 s^2 + 24 k (b + s) of each part of k modes,
/// in vertices.
class CondensedPart {
 public:
  /// The modes that swing.
  struct Modes {
    int most = 0;  ///< and no more than one for eight unknowns of a part, so that contact stays compliant
  };
  /// `places`: of each mesh vertex its place in the motion, or -1: it is fixed, or condensed. Factors K_rr,
  /// on all cores. Throws `Error` where some part of it is held by less than three vertices that are not in
  /// one line, or where all that would take more memory than is free.
  CondensedPart(const ModelInputs& inputs, const std::vector<int>& places, const Modes& modes);

  /// Takes where the border is by now and how fast (m, m/s; 3 x places). O(b^2).
  void observe(const std::vector<double>& u, const std::vector<double>& v) noexcept;
  /// Takes the present displacement of the border, for `carried` alone. O(b).
  void place_at(const std::vector<double>& u) noexcept;
  /// Adds what r does on the border as looked at, but for loads on r, to `force` (3 x places): of a part that
  /// floats, in its frame.
  void follow(std::span<double> force) const noexcept;
  /// The modes go on by h (s) from what was looked at, under these loads.
  void advance(double h, std::span<const VertexLoad> loads) noexcept;
  /// True if a surface vertex is condensed and within reach of tools.
  bool has(int vertex) const noexcept { return part_[static_cast<std::size_t>(vertex)] >= 0; }
  /// Returns those vertices, ascending.
  std::span<const int> vertices() const { return vertices_; }
  /// T u_b + phi_s p of what was looked at, at one of them. O(b).
  Vec3 carried(int vertex) const noexcept;
  /// Contact looks at these surface vertices: they are `watched` until the step after next.
  void watch(std::span<const int> vertices) noexcept;
  /// Returns the watched vertices that are condensed and within reach.
  std::span<const int> watched() const { return watched_; }
  /// A step begins: what contact looked at neither in the last nor in the one before is not watched any more.
  void start_step() noexcept;
  /// Returns the compliance between two of them: motion of one per force on the other, m/N.
  Mat3 compliance(int vertex, int other) const noexcept;
  /// Puts what is watched, or `all` of them, where `free` and W f_s say (surface vertices, m). Loads on
  /// others are passed over. O(loads x what is watched), or of all.
  void apply_loads(std::span<const VertexLoad> loads, bool all, std::span<const Vec3> free,
                   std::span<Vec3> positions) const noexcept;
  /// Adds T^T f_s of one load on one of them to `force` (3 x places).
  void hand_down(const VertexLoad& load, std::span<double> force) const noexcept;

  /// The part that a mesh vertex belongs to, or -1.
  int part_of(int mesh_vertex) const { return part_of_[static_cast<std::size_t>(mesh_vertex)]; }
  /// Ends the modes of a part that nothing holds: it is in equilibrium at every instant. Their mass and
  /// momentum go to the border, in `tensors` and `v` (m/s, 3 x places). Allocates.
  void end_modes(int part, ElasticTensors& tensors, std::vector<double>& v);
  /// Lets a part without modes float with the piece that its border is of. `centre`: of mass of that piece at
  /// rest, m. Allocates.
  void release(int part, const FloatingPieces& pieces, const Vec3& centre);
  /// Takes the present frames of the pieces that float. O(parts).
  void turn(const FloatingPieces& pieces, std::span<const FloatingPieces::Frame> frames) noexcept;

  /// A whole part was removed: it does nothing any more. Returns its elastic energy, less that of the border
  /// with r at rest, and the kinetic energy of its modes, J. Their momentum is not counted.
  CuttableModel::Removed remove(int part) noexcept;

  /// Mass of r that belongs to the border: first number in the motion, kg.
  struct BorderMass {
    int first;
    double kg;
  };
  std::vector<BorderMass> border_masses() const;

  /// Returns the highest angular frequency of the modes, rad/s; 0: there are none.
  double highest_frequency() const;
  std::size_t modes() const;
  std::size_t parts() const { return all_.size(); }
  std::size_t border() const;  ///< vertices, each counted once a part
  std::size_t bytes() const;

 private:
  struct Part {
    std::vector<int> border;          // first numbers in the motion
    std::vector<int> surface;         // surface vertices
    std::vector<double> border_mass;  // kg
    Eigen::MatrixXd following;        // B, of which the lower triangle is read
    Eigen::MatrixXd carrying;         // T^T
    Eigen::MatrixXd compliance;       // W
    Eigen::ArrayXd squares;           // w^2
    Eigen::MatrixXd driven;           // C
    Eigen::MatrixXd shapes;           // phi_s^T
    Eigen::VectorXd p, p_v, p_bent;   // amplitudes, their rates, p + stiffness p_v
    Eigen::VectorXd at, bent, force;  // u_b, u_b + stiffness v_b, B times that
    Eigen::VectorXd surface_rest;     // m
    bool removed = false, floats = false;
    FloatingPieces::Frame frame{Mat3::Identity(), Vec3::Zero()};  // where it floats
    Vec3 centre = Vec3::Zero();                                   // of its piece at rest, m
    Eigen::VectorXd border_rest;                                  // from there, m
  };
  static void place_at(Part& part, const std::vector<double>& u) noexcept;
  static void take_modes_in(Part& part);
  void find_parts(const TetMesh& mesh, std::span<const int> held);
  void number_surface(const ModelInputs& inputs);
  static void condense(const ModelInputs& inputs, const LinearStatics& statics, const std::vector<int>& rows,
                       const SparseMatrix& coupling, Part& part);
  static void take_modes_out(Part& part);

  std::vector<Part> all_;
  std::vector<int> part_of_;     // of mesh vertices
  std::vector<int> part_, row_;  // of surface vertices: its part or -1, and the first row in it
  std::vector<int> vertices_, watched_;
  std::vector<int> seen_;  // of surface vertices: the step in which contact last looked at it
  int step_ = 2;
  RayleighDamping damping_;
};

}  // namespace palpate::sim
