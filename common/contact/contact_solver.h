#pragma once
#include <array>
#include <limits>
#include <span>
#include <vector>

#include "common/contact/bounded_matrix.h"
#include "common/contact/complementarity.h"
#include "common/contact/coulomb.h"
#include "common/contact/narrow_phase.h"
#include "common/contact/simplex_distance.h"
#include "common/contact/tool.h"

namespace palpate {

struct ContactPatch;

/// Tells the compliance of the nodes of a patch column by column.
class ComplianceSource {
 public:
  virtual ~ComplianceSource() = default;
  /// Fills the diagonal blocks (3 x 3) and `tool_compliance` of a patch whose nodes are `patch.vertices`.
  virtual void begin(ContactPatch& patch) const noexcept = 0;
  /// Fills columns 3 node to 3 node + 2.
  virtual void fill(int node, ContactPatch& patch) const noexcept = 0;
  /// Returns true if each of these vertices yields by itself alone, under a rigid tool; then writes its
  /// compliance, m/N, into `each`, of equal size.
  virtual bool each_alone(std::span<const int> /*vertices*/, std::span<Mat3> /*each*/) const noexcept {
    return false;
  }
};

/// The piece of surface near a tool, with all that is needed to solve its contact: the server takes it out of
/// the organ, and the same few arrays would travel to a client.
struct ContactPatch {
  std::vector<Vec3> free;                     ///< (m) node positions without contact, m, world
  std::vector<std::array<int, 3>> triangles;  ///< corners index `free`
  BoundedMatrix compliance;                   ///< leading (3m x 3m): displacement per force at the nodes, m/N
  double tool_compliance = 0;  ///< m/N, isotropic, between the tool position and its tip; 0 = rigid
  /// Tells columns of `compliance` as contact asks for them: of most nodes none are needed. Absent: all are
  /// there. `begin` of the source has been called since the nodes were gathered.
  const ComplianceSource* source = nullptr;
  std::span<const int>
      vertices;  ///< (m) the vertices of the surface that the nodes are; may be empty without a source
  std::vector<char> filled;  ///< (m) with a source: whether the columns of a node are there

  int nodes() const { return static_cast<int>(free.size()); }
  /// Makes room for `max_nodes` and `max_triangles`, once; afterwards nothing here allocates within them.
  void reserve(int max_nodes, int max_triangles);
  /// Makes sure of the columns of a node.
  void require(int node) noexcept;
};

/// Outcome of one contact solve.
struct ContactForce {
  Vec3 force = Vec3::Zero();   ///< on the tool at its tip, N, world: of equal work on a pivoting shaft
  Vec3 torque = Vec3::Zero();  ///< on the tool about its tip, N m; 0 for a shaft that pivots
  int contacts = 0;            ///< touching features
  int iterations = 0;          ///< linearisations used
  bool converged = true;       ///< false: the answer is finite, but the geometry still moved by more than the
                               ///< tolerance, or more touches than there is room for
};

/// Force on the tool at a feature that it touches.
struct FeatureForce {
  std::array<int, 3>
      vertex;  ///< of the surface, ascending, unused entries -1; or nodes of a patch without them
  Contact::Part part;
  int tool;
  bool friction;  ///< across the normal of that vertex, by friction; else along the normal
  Vec3 force;     ///< N
};

/// Start of an increment. Slip is measured from it, and there is no other memory of friction: a node without
/// contact carries none. The result of `solve` is the start of the next increment: nodes at `free` + u, the
/// tip at the pose + u_tip. So a path is a chain of solves, on the server and wherever it is replayed. A
/// caller may put all of it ahead by a part of what nodes and tip did in the increment before: slip is then
/// that at the end of the increment, to second order. What stuck then is not ahead of the tip.
struct IncrementStart {
  std::span<const Vec3> nodes;  ///< (m) the patch nodes, m, world; more do no harm
  Vec3 tip = Vec3::Zero();      ///< the tool's tip, m, world
  Quat q_W = Quat::Identity();  ///< the tool's orientation
  /// Forces to look from, as of the increment before; of the first tool, those of all.
  std::span<const FeatureForce> forces = {};
};

/// A tool in a solve.
struct TouchingTool {
  const Tool* tool;  ///< not null
  ToolPose pose;
  IncrementStart start = {};                           ///< read where a tool of the solve has friction
  std::span<const std::array<int, 3>> triangles = {};  ///< of the patch: those that it may touch
};

/// Unilateral contact of tools with an elastic triangle patch, with Coulomb friction where a tool has some:
/// one problem for all of them. Finds displacements u of the nodes and of the tips, normal forces lambda n of
/// the features (faces, edges, vertices) and friction t at their nodes, with
///   u = C W^T (lambda n, t),   lambda >= 0,   gap(x + u) >= 0,   lambda . gap = 0,
///   |t| <= mu |N|,   t = -mu |N| s / |s| where it slips by s in the increment, s = 0 where it sticks,
/// gap = distance to each feature minus radius, W = tip minus the contact point's share of each node, C the
/// compliance of patch and tip together, N the normal forces that a node bears, s the part of tip minus node
/// (position - position at the start) across N (Duriez et al. 2006: backward Euler of Coulomb's law; by
/// nodes, as features are often more, and their friction then is not determined). The gap is that of the
/// *deformed* surface: each iteration linearises it, solves the small problem on the Delassus operator G = W
/// C W^T (normals only, by a ComplementaritySolver, where there is no friction; else a CoulombSolver), and
/// repeats until nothing moves: without friction force is a function of place and not of step size. Newton
/// steps, the same problem with the compliance that the curvature of the gaps leaves, make that quick. The
/// tip must start outside the surface and within half a radius of a solved place; Simulation takes care of
/// that. Allocates only in the constructor; one thread.
class ContactSolver {
 public:
  /// Largest patch it will be given; whether tools with friction will come, whose problem has up to three
  /// rows more for each node; how many tools at once, at most `kMaxTools`.
  ContactSolver(int max_nodes, int max_triangles, bool friction = false, int tools = 1);

  /// Limits and tolerances of a solve.
  struct Effort {
    int max_iterations = 200;
    double tolerance = 1e-11;  ///< of the tool radius: what still moves at the end
    double expected = 1;       ///< of the tool radius: how far things may have moved since `u` was right
    double work = std::numeric_limits<double>::infinity();  ///< multiplications, before it gives up
  };

  /// Solves for all `tools` (T) at once, and writes the force on each into `forces` (T). `u` (3 (m + T):
  /// nodes, then tips; m) holds the displacement to look from and gets the solution, which does not depend on
  /// it but by rounding. Cost: iterations x (contacts^2 x nodes); about 20 us for a handful of contacts, with
  /// friction some ten times that.
  void solve(ContactPatch& patch, std::span<const TouchingTool> tools, Eigen::Ref<Eigen::VectorXd> u,
             std::span<ContactForce> forces, const Effort& effort = kUsualEffort) noexcept;
  /// Solves for one tool, at `pose`, that may touch all triangles of the patch.
  ContactForce solve(ContactPatch& patch, const Tool& tool, const ToolPose& pose,
                     Eigen::Ref<Eigen::VectorXd> u, const IncrementStart& start = {},
                     const Effort& effort = kUsualEffort) noexcept;
  static const Effort kUsualEffort;

  /// Returns the work of the last solve, multiplications, roughly.
  double work() const noexcept { return work_.used(); }

  /// Nodal forces on the patch nodes (3m, N) of the last solve; the tissue feels minus what the tool feels.
  Eigen::Ref<const Eigen::VectorXd> node_forces() const { return node_force_.head(force_size_); }
  /// Returns the forces of the last solve, feature by feature.
  std::span<const FeatureForce> feature_forces() const noexcept { return rendered_; }
  /// Writes the part of these forces that one tool exerts into `forces` (3m).
  void node_forces_of(int tool, Eigen::Ref<Eigen::VectorXd> forces) const noexcept;

  /// Tangent dF/dp of one tool of the last solve (N/m), the loads of the others held, by the implicit
  /// function theorem on the features it touches, with the curvature of their gaps. Symmetric without
  /// friction. With it: how F follows the end of this same increment; where contacts slip it is not
  /// symmetric, as friction turns with the slide and grows with the pressure, and where they slip by little
  /// it is steep across the slide. Zero when nothing touches or where it is not defined.
  Mat3 tangent(const ContactPatch& patch, int tool = 0) noexcept;

  /// Visits the change of the forces on the patch nodes with the tool position, to first order (N/m). Calls
  /// `visit` with a node and a `Mat3` for each. Of the last `tangent`, before another `solve`; no calls with
  /// friction, or without a tangent.
  template <class Visit>
  void for_load_changes(const Visit& visit) const {
    if (!second_.has_load_change) return;
    for (std::size_t i = 0; i + path_.tools.size() < second_.nodes.size(); ++i)
      visit(second_.nodes[i], Mat3(second_.load_change.middleRows<3>(3 * static_cast<Eigen::Index>(i))));
  }

  /// Returns the memory of its matrices, bytes.
  std::size_t bytes() const;

  /// Compliance in series with every contact of a patch of so many nodes, m/N: it keeps the Delassus operator
  /// positive definite where contacts coincide or nodes are fixed. A millionth of the mean compliance of a
  /// node along an axis (and of the tool), at most 1e-9, ten thousand times stiffer than a liver's contact.
  /// Across the normal a tenth of it, as there it is a creep, by that much per N and increment.
  static double contact_compliance(const ContactPatch& patch, int nodes) noexcept;
  /// Returns that compliance for nodes of this mean compliance with the tool, m/N.
  static double contact_compliance(double mean) noexcept;

 private:
  /// Number of rows of the problem.
  Eigen::Index rows() const {
    return static_cast<Eigen::Index>(contacts_.size() + 2 * friction_nodes_.places.size());
  }
  const Contact& contact_of(Eigen::Index row) const;
  Eigen::Index tip_of(int tool) const;
  Vec3 direction(Eigen::Index row) const;
  double along(Eigen::Index row, Eigen::Index nodes, const Eigen::Ref<const Eigen::VectorXd>& u) const;
  Vec3 travel(Eigen::Index row) const;
  std::array<int, 3> vertices_of(const Contact& c) const;
  void start_increment(const ContactPatch& patch, std::span<const TouchingTool> tools) noexcept;
  bool find_contacts(std::span<const TouchingTool> tools, const Eigen::Ref<const Eigen::VectorXd>& u,
                     double change) noexcept;
  bool find_friction_nodes(const ContactPatch& patch) noexcept;
  void average_contacts(const Eigen::Ref<const Eigen::VectorXd>& force) noexcept;
  void linearise(ContactPatch& patch, const Eigen::Ref<const Eigen::VectorXd>& u) noexcept;
  void assemble_delassus(const ContactPatch& patch) noexcept;
  void displace(const ContactPatch& patch, Eigen::Ref<Eigen::VectorXd> next) const noexcept;
  void consider() noexcept;
  void consider_all() noexcept;
  FrictionPlaces friction_considered() const { return {second_.shares, second_.mu}; }
  bool solve_contacts(const Eigen::Ref<const Eigen::VectorXd>& gap, Eigen::Ref<Eigen::VectorXd> force,
                      bool near = false) noexcept;
  void store(const Eigen::Ref<const Eigen::VectorXd>& force) noexcept;
  bool recall(Eigen::Ref<Eigen::VectorXd> force) const noexcept;
  bool plain_step(const ContactPatch& patch, Eigen::Ref<Eigen::VectorXd> next) noexcept;
  bool is_passed() const noexcept;
  void collect_result(int nodes, const ContactForce& outcome, std::span<ContactForce> forces) noexcept;
  // Second order, in contact_derivatives.cpp:
  void collect_nodes(int nodes) noexcept;
  void differentiate_contacts(int nodes) noexcept;
  void differentiate_friction(int considered, const SimplexHessian* h, const WeightGradient& weights,
                              std::span<const int> slot) noexcept;
  bool differentiate_considered(const ContactPatch& patch) noexcept;
  // and in contact_newton.cpp:
  template <class Visit>
  void each_block_of_curvature(const Visit& visit) const;
  void assemble_system(const ContactPatch& patch) noexcept;
  template <class Visit>
  void each_slot(Eigen::Index row, const Visit& visit) const;
  void spread_over(Eigen::Index first, bool forces, Eigen::Ref<Eigen::MatrixXd> moved) const noexcept;
  void find_gap_changes(Eigen::Index from, Eigen::Index to) noexcept;
  bool respond(const ContactPatch& patch, const Eigen::Ref<const Eigen::MatrixXd>& loads) noexcept;
  bool solve_on_active_set(const Eigen::Ref<const Eigen::VectorXd>& gap,
                           Eigen::Ref<Eigen::VectorXd> force) noexcept;
  bool solve_newton_contacts(const Eigen::Ref<const Eigen::VectorXd>& gap,
                             Eigen::Ref<Eigen::VectorXd> force) noexcept;
  void consider_near(double change) noexcept;
  bool newton_step(const ContactPatch& patch, const Eigen::Ref<const Eigen::VectorXd>& u, double change,
                   Eigen::Ref<Eigen::VectorXd> next) noexcept;
  bool differentiate_forces(Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, 3>> change) noexcept;
  Mat3 tangent_of_considered(const ContactPatch& patch, int tool) noexcept;

  WorkBudget work_;
  double contact_compliance_ = 0, friction_compliance_ = 0;  // m/N, of this patch
  int most_nodes_, most_contacts_;                           // of a Newton step and of the tangent
  // Rows are those of the contacts, along their normals; then two of each place of friction, across it.
  ComplementaritySolver complementarity_;
  CoulombSolver coulomb_;
  std::vector<Contact> contacts_;
  /// Nodes at which friction acts: each node of a contact of a tool with friction, once.
  struct FrictionNodes {
    std::vector<Contact> places;   // of a node alone, with the means of its contacts
    std::vector<Mat3> frames;      // of each: normal and the two directions across it, as columns
    std::vector<double> pressing;  // N, on each along its normal; 0: faint
    std::vector<FrictionPlaces::Share> shares;
    std::vector<int> at_node;  // of each tool in turn; -1: none
  } friction_nodes_;
  std::vector<FeatureForce> rendered_;  // what touched in the iteration before
  std::vector<Vec3> deformed_;
  BoundedMatrix response_;  // C~ A, then C~ of other loads, in the rows of the loaded nodes
  BoundedMatrix delassus_;  // and B C~ of other loads, to its right
  Eigen::VectorXd gap_, lambda_, slack_, next_, increment_, node_force_;
  int force_size_ = 0;
  /// A tool in the increment in hand.
  struct MovedTool {
    bool pivots = false;
    double radius = 0;                                // m
    Vec3 tip_was = Vec3::Zero(), tip = Vec3::Zero();  // where the tip began, and is, m
    Mat3 turned = Mat3::Zero();    // what the tool's turn in the increment did to an arm of now
    Vec3 tip_load = Vec3::Zero();  // N
  };
  /// The increment in hand.
  struct Increment {
    std::vector<Vec3> was;          // where the nodes began, m
    std::span<const int> vertices;  // that the nodes are; empty: numbered as the nodes
    std::vector<MovedTool> tools;
    bool has_friction = false;  // one of them has
  } path_;
  /// Entry of a row of B.
  struct GapChange {
    int at;
    Vec3 by;
  };
  /// Second derivatives: the contacts considered, their nodes (the tip last), and matrices over those nodes.
  struct SecondOrder {
    std::vector<int> considered, friction_nodes, rows, active, nodes, slot_of_node;
    std::vector<GapChange> gap_changes;  // a row of B, where it is not zero
    std::vector<FrictionPlaces::Share> shares;
    std::vector<double> mu;
    int system_sign = 1;  // of the determinant of I - C S
    int unloaded = 0;     // of `nodes`, the first ones
    BoundedMatrix curvature, compliance, bent, toward, system, jacobian;
    BoundedMatrix spread, turning;  // A, and dw/dlambda at fixed places, only with friction
    Eigen::Matrix<double, Eigen::Dynamic, 3> moved, rhs, load_change;
    bool has_load_change = false;
  } second_;
};

}  // namespace palpate
