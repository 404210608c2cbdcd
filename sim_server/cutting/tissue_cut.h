#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sim_server/contact/tool_step.h"
#include "sim_server/cutting/resection.h"

namespace palpate::sim {

/// Removed tetrahedron.
struct Removal {
  double t = 0;  ///< s of all steps before the one that it went in
  int tetrahedron = 0;
};

/// Row of the log of a resection: one step.
struct ResectionRow {
  double t = 0;  ///< s of all steps before it
  std::size_t tool = 0;
  Vec3 p_W = Vec3::Zero();  ///< of its tip, m
  Vec3 f_W = Vec3::Zero();  ///< on it at the end of the step, N
  bool contact = false;     ///< at the end of the step
  ResectionTotals totals;   ///< at the end of the step
};

/// The organ that is cut, and the tools on it: all that a cut changes beside the `TissueCut` itself.
struct CutOrgan {
  TetMesh& mesh;
  Surface& surface;
  std::vector<Vec3>& rest;  ///< surface vertices at rest, m
  Tissue& tissue;
  std::span<ToolContact> tools;
};

/// Options of a run that cuts, beyond its scene.
struct CutOptions {
  bool keeps_log = true;  ///< false: only the last row, for a run of days
  /// True: a step waits for background work, so that the same is published in the same step on every machine.
  /// False, of a live run: it is published once it is ready.
  bool waits_for_background = true;
  /// Tetrahedra to remove, each in the first step that begins at its time or later (s, ascending), in place
  /// of heat and blades.
  std::optional<std::vector<Removal>> planned = {};
};

/// Tools that remove tissue by heat and part it by blades, and the resistance that a blade still has to work
/// off. A value, but for what `Resection` shares with its mesh. One thread; allocates.
class TissueCut {
 public:
  /// Prepares a scene with [cutting]. Gives `surface` the vertices of all that can be cut. `held`: mesh
  /// vertices that are fixed, ascending. The mesh outlives this. Throws `Error` as `removable_tetrahedra`.
  TissueCut(const Scene& scene, TetMesh& mesh, std::span<const int> held, Surface& surface);

  void set_options(CutOptions options);

  /// Cuts the organ at the beginning of a step of `dt` (s), which begins at `time` (s). Where this throws,
  /// the next step begins it again. Returns true where another surface is published from this step on.
  bool start_step(std::span<const ToolInput> inputs, double time, double dt, CutOrgan organ);
  /// Adds the resistance against a blade to the force on its tool, so that it does the work that it owes over
  /// the next `Resection::blade_size` or so.
  void resist(std::size_t tool, const ToolContact& contact, double dt, ToolAnswer& answer);
  /// Notes the outcome of a step that began at `time` (s).
  void end_step(std::span<const ToolInput> inputs, double time, double dt, std::span<const ToolContact> tools,
                std::span<ToolAnswer> answers);

  /// True while a blade of this tool resists.
  bool resists(std::size_t tool) const { return blades_[tool] && !blades_[tool]->force.isZero(0); }
  const Resection& resection() const { return resection_; }
  /// Returns 1 for each surface vertex of a part that floats, which turns and flies; empty: none floats.
  std::span<const char> floating() const { return floating_; }
  /// Surface published to clients near the tools; null: none now.
  const std::shared_ptr<const PublishedSurface>& published() const { return published_; }
  /// Rows of the steps with a tip that was hot.
  std::span<const ResectionRow> log() const { return log_; }
  /// Tetrahedra that heat has removed, in order, without the pieces that this cut off.
  std::span<const Removal> removals() const { return removed_; }
  std::size_t bytes() const { return resection_.bytes() + log_.capacity() * sizeof(ResectionRow); }

 private:
  /// A blade while it cuts, and until it has done the work of that.
  struct Blade {
    BladeEdge is{};                     // m
    std::optional<BladeEdge> was = {};  // at the last look for what it parts; none: it was released
    Vec3 trail = Vec3::Zero();          // `BladeSweep`, m
    std::vector<Vec3> were = {};        // surface vertices then, m
    std::optional<Vec3> place = {};     // of the tool at the end of the step before, m
    double debt = 0;                    // J of what it has parted
    bool outran = false;                // by more than its edge in a step: that is felt too late
    Vec3 force = Vec3::Zero();          // on it, N
  };
  bool is_hot(std::size_t tool, const ToolContact& contact, const ToolInput& input) const;
  std::span<const int> remove_by_heat(std::span<const ToolInput> inputs, double dt, CutOrgan& organ);
  std::span<const int> remove_planned(double time, CutOrgan& organ);
  bool part_by_blades(std::span<const ToolInput> inputs, double dt, CutOrgan& organ);
  bool part_by(std::size_t tool, double dt, CutOrgan& organ);
  void follow_rest(const Separated& separated, std::size_t tool, CutOrgan& organ);
  void let_float(CutOrgan& organ);
  void change_surface(CutOrgan& organ);
  bool publish(std::span<const ToolInput> inputs, CutOrgan& organ);
  void count(const CuttableModel::Removed& lost);

  Resection resection_;
  std::vector<char> floating_ = {};  // of surface vertices
  std::vector<ToolSettings> tools_;
  double toughness_;  // J/m^2
  CutOptions options_;
  std::vector<std::optional<Blade>> blades_;  // of each tool
  std::vector<HotTip> tips_ = {};
  std::vector<std::optional<Vec3>> hot_at_;     // of tools hot in the step before, where that began
  std::vector<ClientModel::Tool> asking_ = {};  // tools whose clients ask for the surface
  std::shared_ptr<const PublishedSurface> published_ = {};
  std::uint32_t touchable_version_ = 0;  // of the resection: whose surface the tools touch
  std::vector<Split> splits_ = {};       // of surface vertices since then, in order
  std::vector<ResectionRow> log_ = {};
  std::vector<Removal> removed_ = {};
  std::size_t done_ = 0;  // of the planned removals
};

}  // namespace palpate::sim
