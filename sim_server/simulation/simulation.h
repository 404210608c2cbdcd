#pragma once
#include <cstdint>
#include <memory>
#include <optional>

#include "sim_server/mesh/tet_mesh.h"
#include "sim_server/scene/scene.h"
#include "sim_server/simulation/flagged_steps.h"
#include "sim_server/simulation/step_publisher.h"
#include "sim_server/simulation/strain_range.h"
#include "sim_server/tissue/model_inputs.h"

namespace palpate::sim {

inline const Progress kSilent = [](std::string_view, double) {};

/// Steps that could not be finished because the model threw, by reason.
struct StepFailures {
  std::uint64_t out_of_memory = 0;
  std::uint64_t other = 0;
};

/// State of a `Simulation` as a value: copies are cheap and share what they hold, which never changes.
class SimulationState {
 private:
  friend class Simulation;
  struct Saved;
  std::shared_ptr<const Saved> saved_;
};

/// The organ of a scene with its tools: one step, one page. Built from a scene (throws `Error`), then stepped
/// by one thread. A step depends on nothing but its arguments and the state, and does not throw: where the
/// model does, its answers are those of the step before, flagged (half of their forces each further time in
/// a row), and the failure is counted. A step does not allocate, lock or log, but for a model that says that
/// it does (`DeformationModel`), and where the scene has [cutting], whether or not it is being cut.
class Simulation {
 public:
  /// Reads the mesh file that the scene names. `condensed`: what set-up takes or makes instead of what the
  /// cache has (`sim_server condense`).
  explicit Simulation(const Scene& scene, const Progress& progress = kSilent,
                      const SetupCache* cache = nullptr, const Condensed* condensed = nullptr);
  /// Takes a mesh made elsewhere.
  Simulation(const Scene& scene, TetMesh mesh, const Progress& progress = kSilent,
             const SetupCache* cache = nullptr, const Condensed* condensed = nullptr);

  /// Advances the tissue by `dt` (s >= 0; the run begins at time 0) with one input for each tool. Returns one
  /// answer for each tool, valid until the next step.
  std::span<const ToolAnswer> step(std::span<const ToolInput> inputs, double dt) noexcept;
  /// Steps with tool 0 alone, the others lifted.
  ToolForce step(const ToolPose& pose, double dt) noexcept;

  /// Returns all that steps and cuts change. Waits for background work. Allocates.
  SimulationState save();
  /// Takes over a state that this simulation saved, and continues byte for byte as it did from there.
  /// Allocates.
  void restore(const SimulationState& state);

  /// Returns the force on a tool at `p_W` (m), near its place, to first order; without effect on anything.
  /// Throws what the model throws. `known`: the answer of `step` for that place, with its tangent; null: to
  /// be solved for. Symmetric without friction; without a normal where no surface is within twice the radius.
  /// At most two contact solves.
  Linearisation linearise(std::size_t tool, const Vec3& p_W, const ToolForce* known);

  std::size_t tools() const { return tools_.size(); }
  /// Contact instants within a step.
  int instants() const { return tissue_.traits.instants; }
  /// Modes that clients step between samples; null: none are published. A tissue that relaxes publishes them
  /// to one tool alone, as no sample tells its memory of the loads of others.
  const PublishedModes* published_modes() const noexcept;
  /// Number that changes whenever another surface, or none, is published. Stays 0 where nothing is cut.
  std::uint32_t published_version() const { return state_.published_version; }
  /// Surface published near the tools of tissue that can be cut; null: none now, or all of it for good.
  std::shared_ptr<const PublishedSurface> published_surface() const noexcept;
  const ToolContact& tool(std::size_t i) const { return tools_[i]; }
  /// Loads of a tool on the surface.
  std::span<const VertexLoad> loads(std::size_t tool) const noexcept { return tissue_.loads_of(tool); }
  /// Distance of a tool from the surface that it can touch, m; nothing for a lifted tool. O(vertices).
  std::optional<double> gap(std::size_t tool) const noexcept;
  /// Triangles that a tool can touch; corners: surface vertices.
  std::span<const Triangle> touchable(std::size_t tool) const { return tools_[tool].touchable(); }
  const DeformationModel& model() const { return *tissue_.model; }
  const ModelTraits& traits() const { return tissue_.traits; }
  /// True unless the last step was held for want of a balance of forces.
  bool balanced() const noexcept;
  /// Positions of all mesh vertices, m; empty where the model does not know them.
  std::span<const Vec3> nodes() const noexcept;
  /// Surface vertices at rest, m, world.
  const std::vector<Vec3>& rest() const { return organ_.rest; }
  const TetMesh& mesh() const { return *organ_.mesh; }
  const Surface& surface() const { return organ_.surface; }
  std::span<const Vec3> positions() const { return tissue_.positions; }
  std::vector<MemoryPart> memory() const;

  /// FNV-1a hash of the surface positions and the last forces, bit by bit: equal runs have equal hashes.
  std::uint64_t state_hash() const noexcept;
  /// The cut of an organ that can be cut; null: it cannot.
  const TissueCut* cut() const { return cut_ ? &*cut_ : nullptr; }
  /// Sets how a run cuts, before its first step. Of an organ that can be cut.
  void set_cut_options(CutOptions options);
  /// Returns the remaining and removed tissue of an organ that can be cut; null: it cannot.
  const Resection* resection() const { return cut_ ? &cut_->resection() : nullptr; }
  const StepFailures& failures() const { return state_.failures; }
  const FlaggedSteps& flagged() const { return state_.flagged; }
  /// Strain under the tools; null: this organ does not deform.
  const StrainRange* strain() const { return state_.strain ? &*state_.strain : nullptr; }

 private:
  friend class SimulationState;
  /// Body as the mesh file and the cuts so far have it.
  struct Organ {
    std::unique_ptr<TetMesh> mesh;  // at one address: a cut refers to it
    Surface surface;
    std::vector<Vec3> rest;   // surface vertices, m
    double furthest = 1e150;  // m from rest: beyond that a body that is held ran away
  };
  /// Mean forces of one tool within the step.
  struct Mean {
    Vec3 all = Vec3::Zero();   // at the instants, N
    Vec3 late = Vec3::Zero();  // at the last of them, N
  };
  /// State that a step changes beside organ, tissue and tools.
  struct State {
    double time = 0;                        // s, of all steps
    bool failed = false, ran_away = false;  // in the last step
    std::uint32_t published_version = 0;
    StepFailures failures = {};
    FlaggedSteps flagged = {};
    std::optional<StrainRange> strain = {};
    std::vector<InstantPath> paths = {};  // of each tool
    std::vector<Mean> means = {};
    std::vector<ToolAnswer> answers = {};
  };

  void advance(std::span<const ToolInput> inputs, double dt);
  void advance_to_instant(std::span<const ToolInput> inputs, int instant, double dt);
  void move_organ(double dt);
  void answer(std::size_t tool, const ToolInput& input, double dt);
  void hold_answers(std::span<const ToolInput> inputs) noexcept;
  void explain_flagged() noexcept;
  void judge_place(const ToolContact& tool, ToolAnswer& answer) noexcept;
  void release_tool(std::size_t tool) noexcept;
  bool ran_away() const noexcept;
  std::span<const char> floating() const noexcept;
  CutOrgan cut_organ() { return {*organ_.mesh, organ_.surface, organ_.rest, tissue_, tools_.all()}; }
  OrganAfterStep after_step() { return {tissue_, tools_, organ_.rest, cut()}; }

  Organ organ_;
  std::optional<TissueCut> cut_;
  Tissue tissue_;
  ToolGroup tools_;
  StepPublisher publisher_;
  State state_;
  std::vector<ToolInput> inputs_;  // for the step of tool 0 alone
};

/// Returns "contact", or "contact of tool 2" where there are several: the name of a tool's part in reports.
std::string contact_part(std::size_t tool, std::size_t tools);
/// Returns the stage of set-up that makes it: "preparing contact".
std::string contact_stage(std::size_t tool, std::size_t tools);

}  // namespace palpate::sim
