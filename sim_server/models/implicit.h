#pragma once
#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <string_view>

#include "common/config.h"
#include "sim_server/client_model/published_motion.h"
#include "sim_server/client_model/published_relaxation.h"
#include "sim_server/scene/loads.h"
#include "sim_server/solvers/dynamics.h"
#include "sim_server/statics/moving_supports.h"
#include "sim_server/tissue/contact_instants.h"
#include "sim_server/tissue/estimated_memory.h"

namespace palpate::sim {

/// Settings of the solution of each step.
struct ImplicitSettings {
  bool second_order = false;  ///< `integrator` = "bdf2"; else "backward_euler"
  DynamicsSettings::Solver solver = DynamicsSettings::Solver::kDirect;
  int refresh_steps = 8;    ///< from one factor of the background to the next, [1, 1000]
  int max_newton = 5;       ///< iterations of Newton's method in a step that balances, [1, 100]
  double tolerance = 1e-5;  ///< the relative residual that they may leave, [1e-12, 0.1]

  /// Norm of the residual that columns of compliance may leave of three unit forces: less matters little, as
  /// each iteration looks at the true forces again.
  double column_tolerance() const { return std::min(1e-3, 100 * tolerance); }

  static constexpr std::array<std::string_view, 5> kKeys{"integrator", "solver", "refresh_steps",
                                                         "max_newton", "tolerance"};
  static ImplicitSettings read(const Config& config);
  std::string to_text() const;
};

/// The damping and the steps of a scene of this model, as `Dynamics` asks for them.
DynamicsSettings dynamics_settings(const DeformationSettings& settings);

/// Tissue of any law in motion, by implicit steps of T, from one instant of contact to the next (`Dynamics`):
/// stable whatever the stiffness. At rest under the scene's [[load]] when the run begins, of which a tissue
/// that relaxes has not relaxed yet: it goes on to give way. Where nothing is fixed, at rest without, and it
/// flies. A step iterates once under the loads of the last one, linearises
/// there, and answers the contact solver from that: compliance W = J A^-1 J^T, dt^2 of the mass-like matrix
/// in it, which is also that over the sample interval, as loads are held over the step. Then it iterates
/// again from where contact led, until Newton's method has converged with contact inside its loop, at most
/// `max_newton` times. Where more than 1 % of the forces are unbalanced then, it iterates twice as
/// many times again; what is not balanced by then is flagged and its answer held, and a body whose factors
/// come from the background takes the next one as soon as it is ready. The factor of A is kept over steps as
/// long as it serves (where the body rests, none is older than its shape), or made in the background and
/// exchanged every `refresh_steps`: that takes more iterations, but they converge to the balance of the true
/// forces. Columns of W are solved for as they are asked for, and kept while the factor stands: for a linear
/// law from then on; with a factor of the background come those that were asked for while it was made. Moving
/// supports stand at the end of a step where they shall be then; the run begins with the body in equilibrium,
/// at the velocities that it will have by them.
class Implicit final : public DeformationModel,
                       public NonlinearModel,
                       public CuttableModel,
                       public ClientModel,
                       public LaterCompliance,
                       public InteriorView,
                       public StatefulModel {
 public:
  /// Throws `Error` without material or rate, or where what is held does not hold the body.
  explicit Implicit(const ModelInputs& inputs);
  /// Before anything is allocated.
  static double estimated_bytes(const Scene& scene, const MeshCounts& counts);
  FreeMotion free_motion(double dt) override;
  void compliance(std::span<const int> vertices, ContactPatch& patch) const override;
  Mat3 later_compliance(std::span<const VertexLoad> loads, double seconds) const noexcept override;
  const PublishedModes* modes() const noexcept override { return &published_->modes(); }
  void read_modes(ModalMotion& state) override;
  void residual_compliance(std::span<const int> vertices, ContactPatch& patch) const noexcept override;
  std::span<const Vec3> apply(std::span<const VertexLoad> loads) override;
  std::optional<FreeMotion> relinearise() override;
  /// Unbalanced where the last iteration found a relative residual above 1 %.
  Balance balance() const noexcept override;
  std::span<const Vec3> nodes() const noexcept override { return dynamics_.position(); }
  Removed remove(std::span<const int> tetrahedra, const CutMesh& remaining) override;
  void part(std::span<const Slide> slides, const Parting& parting, const CutMesh& remaining) override;
  void release(std::span<const std::vector<int>> floating, const CutMesh& remaining) override;
  ModelTraits traits() noexcept override;
  std::vector<MemoryPart> memory() const override;
  std::any save() override;
  FreeMotion restore(const std::any& state) override;

 private:
  void begin(const ModelInputs& inputs);
  void apply_new_loads();
  void end_step_in_hand();
  std::vector<Dynamics::NodeMass> masses_of(const std::set<int>& nodes, const CutMesh& remaining) const;
  FreeMotion motion() const;
  struct Carried {
    std::vector<Vec3> positions, velocities;
  };
  Carried carried() const;
  void store();
  Eigen::VectorXd displacement(std::span<const Vec3> from) const;
  void update_surface();
  void request_columns();
  void replace_columns();
  void clear_columns();
  void find_columns(std::span<const int> vertices) const;
  void keep_columns(const Eigen::MatrixXd& columns) const;
  void add_response(std::span<const VertexLoad> loads, double sign, Eigen::VectorXd& moved) const;
  void apply_loads(std::span<const VertexLoad> loads, double sign, std::span<Vec3> positions) const;
  std::span<const Vec3> external_forces();
  /// True if one iteration solves each step, with the columns of one factor for good.
  bool is_linear() const { return solid_.material().law == ElasticLaw::kLinear && !may_be_cut_; }

  /// Columns of A^-1 of the factor in use, three for each of some surface vertices.
  struct SurfaceColumns {
    std::vector<int> slot;                // per surface vertex: of its columns, or -1
    std::vector<std::uint8_t> requested;  // per surface vertex: 1 where its columns were asked for
    int slots = 0;
    Eigen::MatrixXd values;  // (unknowns x 3 slots or more) m/N
  };
  /// Progress of the step in hand.
  struct Progress {
    int iterations = 0;         // of Newton's method in this step
    int factors = 0;            // of the columns
    bool in_step = false;       // a step has begun
    bool relinearised = false;  // and has been linearised again
  };
  struct State {
    Solid solid;
    Dynamics dynamics;
    std::optional<MovingSupports::State> supports;
    std::optional<PublishedRelaxation> relaxation;
    Progress progress;
    SurfaceColumns columns;
    std::vector<Vec3> free, positions;
    std::vector<VertexLoad> loads, linearised_loads;
  };

  bool may_be_cut_;
  Solid solid_;
  Loads scene_loads_;
  Dynamics dynamics_;
  /// Supports that move. Used for the velocity of the surface (by a linearisation about rest) and the time.
  std::optional<MovingSupports> supports_;
  std::vector<SupportResponse> responses_;         // of all nodes to them, where modes are published
  std::optional<PublishedMotion> published_;       // about rest, where the scene has it
  std::optional<PublishedRelaxation> relaxation_;  // of a tissue that relaxes
  double held_compliance_;                         // m/N, of a fixed vertex under the tool itself
  ImplicitSettings settings_;
  int instants_;   // within a step of the scene
  double period_;  // s, from one to the next
  Progress step_;
  std::vector<int> node_, dof_;      // per surface vertex: its node; its first unknown, or -1: held
  std::vector<Triangle> triangles_;  // of the surface, where columns are requested of the background
  std::vector<int> vertex_;          // per three unknowns: the surface vertex, or -1: inside
  std::vector<Vec3> free_, positions_, external_;     // m; surface vertices; N, nodes
  std::vector<VertexLoad> loads_, linearised_loads_;  // now; those that the linearisation was made under
  mutable SurfaceColumns columns_;
};

}  // namespace palpate::sim
