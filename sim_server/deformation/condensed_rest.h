#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "sim_server/deformation/deformation_model.h"
#include "sim_server/deformation/model_inputs.h"
#include "sim_server/sparse/stiffness_matrix.h"

namespace palpate::sim {

struct LinearStatics;

/// What of a linear tissue is not in motion: at rest at every instant, under what the border to the part in
/// motion does to it and under what tools press. Condensed (Guyan 1965, AIAA J. 3:380; as the elementary
/// deformations of Cotin, Delingette and Ayache 1999) to the vertices of that border, b, and to the surface
/// that tools reach, s. With K of the whole body, r its vertices that are condensed, u displacements and f
/// forces:
///   force on the border where r stays at rest:  -K_bb u_b, which the tensors of the part in motion have;
///   what r adds to it as it follows the border:  B u_b + T^T f_s,  B = K_br K_rr^-1 K_rb  (3b x 3b);
///   where the surface then is:  T u_b + W f_s,  T = -(K_rr^-1 K_rb)_s,  W = (K_rr^-1)_ss.
/// Parts of r that meet only through the border have matrices of their own. One thread; only the constructor
/// allocates and throws. Bytes: 72 b^2 + 72 b s + 72 s^2 of each part, in vertices.
class CondensedRest {
 public:
  /// `places`: of each mesh vertex its place in the motion, or -1: it is fixed, or condensed. Factors K_rr,
  /// on all cores. Throws `Error` where some part of it is held by less than three vertices that are not in
  /// one line, or where all that would take more than the free memory of `inputs`.
  CondensedRest(const ModelInputs& inputs, const std::vector<int>& places);

  /// Takes what the border has by now, of (3 x places).
  void look_at(std::span<const double> motion) noexcept;
  /// Adds B u_b of what was looked at to `force` (3 x places).
  void follow(std::span<double> force) noexcept;
  /// Whether a surface vertex is condensed, and tools reach it.
  bool has(int vertex) const noexcept { return part_[static_cast<std::size_t>(vertex)] >= 0; }
  /// These, ascending.
  std::span<const int> vertices() const { return vertices_; }
  /// T u_b of what was looked at, at one of them. O(b).
  Vec3 carried(int vertex) const noexcept;
  /// Contact looks at these surface vertices: until the step after next, they are kept where they are.
  void watch(std::span<const int> vertices) noexcept;
  /// Those of them that are condensed and reached.
  std::span<const int> watched() const { return watched_; }
  /// A step begins: what contact looked at neither in the last nor in the one before is not watched any more.
  void begin_step() noexcept;
  /// Of two of them: how one moves per force on the other, m/N.
  Mat3 compliance(int vertex, int other) const noexcept;
  /// Moves these of them (`positions` of surface vertices, m) by W f_s. Loads on others are passed over.
  void move(std::span<const NodalLoad> loads, std::span<const int> vertices,
            std::span<Vec3> positions) const noexcept;
  /// Adds T^T f_s of one load on one of them to `force` (3 x places).
  void hand_down(const NodalLoad& load, std::span<double> force) const noexcept;

  /// The part that a mesh vertex belongs to, or -1.
  int part_of(int mesh_vertex) const { return part_of_[static_cast<std::size_t>(mesh_vertex)]; }
  /// A whole part was removed: it does nothing any more. Returns what it gave to the elastic energy of the
  /// border as looked at, -u_b^T B u_b / 2, J.
  double remove(int part) noexcept;

  std::size_t parts() const { return all_.size(); }
  std::size_t border() const;  ///< vertices, each counted once a part
  std::size_t bytes() const;

 private:
  struct Part {
    std::vector<int> border;     // first numbers in the motion
    std::vector<int> surface;    // surface vertices
    Eigen::MatrixXd following;   // B, of which the lower triangle is read
    Eigen::MatrixXd carrying;    // T^T
    Eigen::MatrixXd compliance;  // W
    Eigen::VectorXd at, force;   // u_b, B u_b
    bool gone = false;
  };
  void find_parts(const TetMesh& mesh, std::span<const int> held);
  static void condense(const ModelInputs& inputs, const LinearStatics& statics, const std::vector<int>& rows,
                       const SparseMatrix& coupling, Part& part);

  std::vector<Part> all_;
  std::vector<int> part_of_;     // of mesh vertices
  std::vector<int> part_, row_;  // of surface vertices: its part or -1, and the first row in it
  std::vector<int> vertices_, watched_;
  std::vector<int> seen_;  // of surface vertices: the step in which contact last looked at it
  int step_ = 2;
};

}  // namespace palpate::sim
