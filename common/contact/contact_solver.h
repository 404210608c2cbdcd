#pragma once
#include <array>
#include <vector>

#include "common/contact/complementarity.h"
#include "common/contact/narrow_phase.h"
#include "common/contact/tool.h"

namespace palpate {

/// The piece of surface near a tool, with all that is needed to solve its contact: the server takes it out of
/// the organ, and the same few arrays would travel to a client.
struct ContactPatch {
  std::vector<Vec3> free;                     ///< (m) node positions without contact, m, world
  std::vector<std::array<int, 3>> triangles;  ///< corners index `free`
  Eigen::MatrixXd compliance;                 ///< leading (3m x 3m): displacement per force at the nodes, m/N
  double tool_compliance = 0;  ///< m/N, isotropic, between the tool position and its tip; 0 = rigid

  int nodes() const { return static_cast<int>(free.size()); }
  /// Makes room for `max_nodes` and `max_triangles`, once; afterwards nothing here allocates within them.
  void reserve(int max_nodes, int max_triangles);
};

/// Outcome of one contact solve.
struct ContactForce {
  Vec3 force = Vec3::Zero();  ///< on the tool, N, world
  int contacts = 0;           ///< touching features
  int iterations = 0;         ///< linearisations used
  bool converged =
      true;  ///< false: the answer is finite, the geometry still moved by more than the tolerance
};

/// Frictionless unilateral contact of a sphere with an elastic triangle patch. Finds displacements u of the
/// nodes and of the tool tip, and forces lambda, with
///   u = C J^T lambda,   lambda >= 0,   gap(x + u) >= 0,   lambda . gap = 0,
/// gap = distance to each feature minus radius, J = d gap / d u, C the compliance of patch and tip together.
/// The gap is that of the *deformed* surface: each iteration linearises it, solves a ComplementaritySolver
/// problem on the Delassus operator G = J C J^T, and repeats until nothing moves, so force is a function of
/// place and not of step size. Newton steps, the same problem with the compliance that the curvature of the
/// gaps leaves, make that quick. The tip must start outside the surface and within half a radius of a solved
/// place; Simulation takes care of that. Allocates only in the constructor; one thread.
class ContactSolver {
 public:
  /// Largest patch it will be given.
  ContactSolver(int max_nodes, int max_triangles);

  /// How hard to try.
  struct Effort {
    int max_iterations = 200;
    double tolerance = 1e-11;  ///< of the tool radius: what still moves at the end
    bool newton = true;
  };

  /// Solves for the tool centre `p_W` (m). `u` (3 (m + 1): nodes, then tip; m) holds the starting
  /// displacement and gets the solution. Cost: iterations x (contacts^2 x nodes); about 20 us for a handful
  /// of contacts.
  ContactForce solve(const ContactPatch& patch, const SphereTool& tool, const Vec3& p_W,
                     Eigen::Ref<Eigen::VectorXd> u, const Effort& effort = kUsualEffort) noexcept;
  static const Effort kUsualEffort;

  /// Nodal forces on the patch nodes (3m, N) of the last solve; the tissue feels minus what the tool feels.
  Eigen::Ref<const Eigen::VectorXd> node_forces() const { return node_force_.head(force_size_); }

  /// Tangent dF/dp of the last solve (N/m, symmetric), by the implicit function theorem on the touching
  /// features, with the curvature of their gaps. Zero when nothing touches or where it is not defined.
  Mat3 tangent(const ContactPatch& patch) noexcept;

  /// What its matrices hold, bytes.
  std::size_t bytes() const;

  /// Compliance in series with every contact (m/N): ten thousand times stiffer than a liver's contact, it
  /// keeps the Delassus operator positive definite where contacts coincide or nodes are fixed.
  static constexpr double kContactCompliance = 1e-9;

 private:
  void linearise(const ContactPatch& patch, const SphereTool& tool,
                 const Eigen::Ref<const Eigen::VectorXd>& u);
  void solve_linearised(int nodes, Eigen::Ref<Eigen::VectorXd> next) noexcept;
  void collect_result(int nodes, ContactForce& result) noexcept;
  // Second order, in contact_derivatives.cpp:
  void collect_nodes(int tip) noexcept;
  void differentiate_gaps(int tip) noexcept;
  bool compute_effective_compliance(const ContactPatch& patch) noexcept;
  bool prepare_considered(const ContactPatch& patch) noexcept;
  bool newton_step(const ContactPatch& patch, const Eigen::Ref<const Eigen::VectorXd>& u,
                   Eigen::Ref<Eigen::VectorXd> next) noexcept;
  Mat3 tangent_of_considered(const ContactPatch& patch) noexcept;

  ComplementaritySolver complementarity_;
  std::vector<Contact> contacts_;
  std::vector<Vec3> deformed_;
  Eigen::MatrixXd response_;  // C J^T, (3 (m + 1) x contacts)
  Eigen::MatrixXd delassus_;
  Eigen::VectorXd gap_, lambda_, next_, way_, node_force_;
  int force_size_ = 0;
  // Second order: the contacts considered, their nodes (the tip last), and matrices over those nodes.
  std::vector<int> considered_, nodes_, slot_of_node_;
  Eigen::MatrixXd curvature_, effective_, system_, jacobian_;
  Eigen::Matrix<double, Eigen::Dynamic, 3> moved_, rhs_;
};

}  // namespace palpate
