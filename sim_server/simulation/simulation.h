#pragma once
#include <cstdint>
#include <optional>

#include "sim_server/contact/tool_contact.h"
#include "sim_server/cutting/resection.h"
#include "sim_server/deformation/model_inputs.h"
#include "sim_server/deformation/slow_modes.h"
#include "sim_server/mesh/tet_mesh.h"
#include "sim_server/scene/scene.h"
#include "sim_server/simulation/flagged_steps.h"
#include "sim_server/simulation/tool_coupling.h"

namespace palpate::sim {

inline const Progress kSilent = [](std::string_view, double) {};

/// The force on a tool near a place, to first order.
struct Linearised {
  Vec3 force = Vec3::Zero();    ///< N
  Mat3 tangent = Mat3::Zero();  ///< N/m; free of contact: what it will be when it touches
  SurfacePlane plane;           ///< of contact, or the nearest; no normal: none within twice the radius
};

/// What a step is asked to tell of one tool beyond its force. Nothing is computed that nobody asked for.
struct ToolWants {
  bool tangent = true;  ///< dF/dp of `ToolForce`
  bool here = false;    ///< the linearisation at the tool's pose; with it goes `tangent`
  /// The linearisation where the tool will be after `seconds` (>= 0) at `v_W` (m/s), relative to the organ as
  /// it moves by itself, 2 mm away at most.
  struct Ahead {
    double seconds;
    Vec3 v_W;
  };
  std::optional<Ahead> ahead = {};
  bool surface_shift = false;  ///< of a tool that does not grasp
};

/// Where a tool was at an instant within a step, and how it came from the one before.
struct PathPoint {
  ToolPose pose;
  Bend bend = {};  ///< only friction asks for it
};

/// One tool in one step.
struct ToolInput {
  std::optional<ToolPose> pose = {};  ///< where its tip is now; none: it is lifted
  std::uint16_t buttons = 0;          ///< of its device, pressed now: some tools grasp by them
  Vec3 v_W = Vec3::Zero();            ///< of its tip, m/s: how fast it pushes the organ under other tools
  Bend bend = {};  ///< how it came there from the last point of its path; only friction asks for it
  /// Where it was at the instants within the step before `pose` (`Simulation::instants` - 1), evenly in time.
  /// Of another length, as empty where there are some: it went straight and evenly from its pose of the step
  /// before.
  std::span<const PathPoint> path = {};
  ToolWants wants = {};
};

/// What a step says of one tool: the force on it, and what was asked beyond that, if its pose was known and
/// the force is not flagged.
struct ToolAnswer : ToolForce {
  Vec3 mean_force = Vec3::Zero();  ///< N, over the step; equal to `force` where contact is solved once
  /// How fast the organ's surface moves by itself where the tool touches, or else nearest to it, m/s, world.
  /// Told with `here` and `ahead`; zero where all supports rest.
  Vec3 surface_v_W = Vec3::Zero();
  /// How the other tools move it besides. Told with `here` and `ahead`, where several tools are there.
  std::optional<OtherTools> others = {};
  std::optional<Linearised> here = {};
  struct Ahead {
    Vec3 p_W;  ///< m
    Linearised there;
  };
  std::optional<Ahead> ahead = {};
  /// How far the surface nearest to the tool is from its place at rest, free of that tool but under all
  /// others, m; with `modes`, by its supports, and what of the others' pushing no told mode tells.
  /// O(vertices).
  std::optional<Vec3> surface_shift_W = {};
  /// The tissue's told modes at the end of the step; null without `surface_shift_W`, or where there are none.
  const SlowModes::State* modes = nullptr;
  /// With them: how hard the other tools drive each, N/sqrt(kg); null: there are none.
  const Eigen::VectorXd* modal_loads = nullptr;
  bool cutting = false;  ///< its tip is hot, or its blade cuts: what it touches may give way at any time
};

/// A tetrahedron that is gone.
struct Removal {
  double t = 0;  ///< s of all steps before the one that it went in
  int tetrahedron = 0;
};

/// One step of a resection, for those who judge it.
struct ResectionRow {
  double t = 0;  ///< s of all steps before it
  std::size_t tool = 0;
  Vec3 p_W = Vec3::Zero();  ///< of its tip, m
  Vec3 f_W = Vec3::Zero();  ///< on it at the end of the step, N
  bool contact = false;     ///< at the end of the step
  ResectionTotals totals;   ///< at the end of the step
};

/// Steps that could not be finished because the model threw, by reason.
struct StepFailures {
  std::uint64_t out_of_memory = 0;
  std::uint64_t other = 0;
};

/// The organ of a scene with its tools: one step, one page. Built from a scene (throws `Error`), then stepped
/// by one thread. A step depends on nothing but its arguments and the state, and does not throw: where the
/// model does, its answers are those of the step before, flagged (half of their forces each further time in
/// a row), and the failure is counted. A step does not allocate, lock or log, but for a model that says that
/// it does (`DeformationModel`), and where the scene has [cutting], whether or not it is being cut.
class Simulation {
 public:
  /// With the mesh file that the scene names. `condensed`: what set-up takes or makes instead of what the
  /// cache has (`sim_server condense`).
  explicit Simulation(const Scene& scene, const Progress& progress = kSilent,
                      const SetupCache* cache = nullptr, const Condensed* condensed = nullptr);
  /// With a mesh made elsewhere.
  Simulation(const Scene& scene, TetMesh mesh, const Progress& progress = kSilent,
             const SetupCache* cache = nullptr, const Condensed* condensed = nullptr);

  /// Advances the tissue by `dt` (s >= 0; the run begins at time 0) with one input for each tool. The
  /// answers, one for each tool, stay valid until the next step.
  std::span<const ToolAnswer> step(std::span<const ToolInput> inputs, double dt) noexcept;
  /// The same with tool 0 alone, the others lifted.
  ToolForce step(const ToolPose& pose, double dt) noexcept;

  /// What a tool would feel at `p_W` (m), near where it stands; without effect on anything. Throws what the
  /// model throws. `felt`: what
  /// `step` gave for that place, with its tangent; null: to be found out. At most two contact solves.
  Linearised linearise(std::size_t tool, const Vec3& p_W, const ToolForce* felt);

  /// Takes a tool away: the tissue goes free of it.
  void lift_tool(std::size_t tool = 0) noexcept;

  std::size_t tools() const { return tools_.size(); }
  /// How often contact is solved within a step.
  int instants() const { return instants_; }
  /// The modes that clients step between samples; null: there are none to tell. Of a tissue that relaxes with
  /// one tool: what it remembers of the loads of others, no sample tells.
  const SlowModes* told_modes() const {
    const SlowModes* const modes = tissue_.model->slow_modes();
    const bool told =
        modes != nullptr && modes->told > 0 && (tools_.size() == 1 || modes->relaxations.empty());
    return told ? modes : nullptr;
  }
  /// Another number whenever clients are to be told another surface, or none any more (`ToldSurface`). Of a
  /// tissue that is never cut, it stays 0.
  std::uint32_t told_version() const { return told_version_; }
  /// From now on no step waits for a background: what clients are told comes when it is there. So what is
  /// felt depends on the machine, by when that was.
  void hurry() { hurries_ = true; }
  const ToolContact& tool(std::size_t i) const { return tools_[i]; }
  /// What a tool puts on the surface by now.
  std::span<const NodalLoad> loads(std::size_t tool) const noexcept { return tissue_.loads_of(tool); }
  /// How far a tool is from the surface that it can touch, as it stands, m; nothing of one that is lifted.
  /// O(vertices).
  std::optional<double> gap(std::size_t tool) const noexcept;
  /// Triangles that a tool can touch; corners: surface vertices.
  std::span<const Triangle> touchable(std::size_t tool) const { return tools_[tool].touchable(); }
  const DeformationModel& model() const { return *tissue_.model; }
  /// Surface vertices at rest, m, world.
  const std::vector<Vec3>& rest() const { return rest_; }
  const TetMesh& mesh() const { return *mesh_; }
  const Surface& surface() const { return surface_; }
  std::span<const Vec3> positions() const { return tissue_.positions; }
  std::vector<MemoryPart> memory() const;

  /// FNV-1a hash of the surface positions and the last forces, bit by bit: equal runs have equal hashes.
  std::uint64_t state_hash() const noexcept;
  /// What is left of an organ that is cut, and what has been removed; null: nothing can be.
  const Resection* resection() const { return cut_ ? &cut_->resection : nullptr; }
  /// From now on only the last row of the log is kept: of a run that may go on for days.
  void keep_no_log() {
    if (cut_) cut_->logs = false;
  }
  /// A row for each step with a tip that was hot.
  std::span<const ResectionRow> resection_log() const {
    return cut_ ? std::span<const ResectionRow>(cut_->log) : std::span<const ResectionRow>();
  }
  /// All that heat has removed, in order; not the pieces that this cut off.
  std::span<const Removal> removals() const {
    return cut_ ? std::span<const Removal>(cut_->removed) : std::span<const Removal>();
  }
  /// From now on this is removed, each in the first step that begins at its time or later (s, ascending), and
  /// nothing by heat: so another rate can be held against the one
  /// at which they went. Of an organ that can be cut.
  void remove_at(std::vector<Removal> removals);
  const StepFailures& failures() const { return failures_; }
  const FlaggedSteps& flagged() const { return flagged_; }

 private:
  void advance(std::span<const ToolInput> inputs, double dt);
  void cut(std::span<const ToolInput> inputs, double dt);
  std::span<const int> remove_tissue(std::span<const ToolInput> inputs, double dt);
  void part_tissue(std::span<const ToolInput> inputs, double dt);
  void part_by(std::size_t tool, double dt);
  void tell_near(std::span<const ToolInput> inputs);
  void make_room_for_modes();
  void count_gone(const DeformationModel::Removed& gone);
  void resist_blade(std::size_t tool, double dt, ToolAnswer& answer);
  bool feels_blade(std::size_t tool) const;
  void note_cut(std::span<const ToolInput> inputs, double dt);
  void change_surface();
  PathPoint at_instant(std::size_t tool, const ToolInput& input, int instant) const;
  PathPoint contact_point(std::size_t tool, const ToolInput& input, int instant) const;
  void remember(std::size_t tool, const ToolPose& pose);
  void advance_to_instant(std::span<const ToolInput> inputs, int instant, double dt);
  void count_flagged() noexcept;
  void hold_answers(std::span<const ToolInput> inputs) noexcept;
  bool looks_everywhere(std::size_t tool, const ToolInput& input) const noexcept;
  void narrow_to_tools(std::span<const ToolInput> inputs);
  void move_organ(double dt);
  void settle();
  void flag_contacts() noexcept;
  void solve_contacts();
  void restore_touching();
  void couple(std::span<const ToolInput> inputs);
  Linearised linearise_coupled(std::size_t tool, const Vec3& p_W, const Vec3& there, const ToolForce* felt);
  void add_wanted(std::size_t tool, const ToolInput& input);
  Vec3 surface_shift(std::size_t tool, const Vec3& p_W);
  Vec3 residual_shift(std::size_t tool, int vertex);
  void tell_modes(std::size_t tool);
  bool ran_away() const noexcept;

  /// A blade while it cuts, and until it has done the work of that.
  struct Blade {
    BladeEdge is{};                     // m
    std::optional<BladeEdge> was = {};  // when what it parts was looked for last; none: it was let go
    Vec3 trail = Vec3::Zero();          // `BladeSweep`, m
    std::vector<Vec3> were = {};        // surface vertices then, m
    std::optional<Vec3> place = {};     // of the tool at the end of the step before, m
    double owed = 0;                    // J of what it has parted
    Vec3 force = Vec3::Zero();          // on it, N
  };
  /// Of an organ that may be cut.
  struct Cut {
    Resection resection;
    std::vector<ToolSettings> tools;
    double toughness;                               // J/m^2
    std::vector<std::optional<Blade>> blades = {};  // of each tool
    std::vector<HotTip> tips = {};
    std::vector<DeformationModel::ToldTool> told_near = {};
    std::shared_ptr<const ToldSurface> told = {};  // to clients
    std::uint32_t touchable_version = 0;           // of the resection: whose surface the tools touch
    std::vector<std::optional<Vec3>> hot_at = {};  // of tools hot in the step before, where that began
    std::vector<ResectionRow> log = {};
    bool logs = true;
    std::vector<Removal> removed = {};
    std::optional<std::vector<Removal>> planned = {};  // to be removed, instead of by heat
    std::size_t done = 0;                              // of these
  };

  std::unique_ptr<TetMesh> mesh_;  // what can be cut knows it by its place
  Surface surface_;
  std::optional<Cut> cut_;
  double time_ = 0;  // s, of all steps
  std::vector<Vec3> rest_;
  double farthest_ = 1e150;  // from there, m; so far: no bound but that of numbers
  Tissue tissue_;
  std::vector<ToolContact> tools_;
  std::optional<ToolCoupling> coupling_;            // of several tools
  int instants_ = 1;                                // within a step
  std::vector<std::optional<ToolPose>> came_from_;  // poses of the step before
  std::vector<std::vector<ToolPose>> lately_;       // of each tool: at the last instants, the newest first
  std::vector<Vec3> mean_, late_mean_;  // of the forces at the instants, and at the last of them, N
  std::vector<Vec3> velocities_;        // of the tools, m/s
  std::vector<Vec3> surface_motion_;    // of the surface at each tool in this step, m
  std::vector<Neighbourhood> places_;   // around the ways of the tools in this step
  bool let_go_ = false;                 // some tissue was, since the last step
  std::vector<ToolInput> inputs_;       // for the step of tool 0 alone
  std::vector<ToolAnswer> answers_;
  SlowModes::State modes_;  // of the told modes
  std::uint32_t told_version_ = 0;
  bool hurries_ = false;
  std::vector<Eigen::VectorXd>
      modal_loads_;    // of the told modes, by the other tools of each, where there are some
  ContactPatch pair_;  // of two vertices, to ask how one moves the other
  StepFailures failures_;
  FlaggedSteps flagged_;
  bool tools_settled_ = true, lost_ = false, coupled_ = false;  // in this step
  bool failed_ = false;                                         // the last step
};

/// "contact", or "contact of tool 2" where there are several: the name of a tool's part in reports.
std::string contact_part(std::size_t tool, std::size_t tools);
/// The stage of set-up that makes it: "preparing contact".
std::string contact_stage(std::size_t tool, std::size_t tools);

}  // namespace palpate::sim
