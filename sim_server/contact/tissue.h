#pragma once
#include <memory>
#include <span>
#include <vector>

#include "sim_server/deformation/deformation_model.h"

namespace palpate::sim {

class ToolTissue;

/// The tissue as all tools share it, with the loads of each. Positions are those of the surface vertices, m,
/// world. Only set-up allocates; what the model throws passes through. One thread.
class Tissue {
 public:
  std::unique_ptr<DeformationModel> model;
  std::span<const Vec3> free;        ///< in this step, without any contact
  std::span<const Vec3> velocities;  ///< of that, m/s; empty: it rests
  std::span<const Vec3> positions;   ///< now, under the loads of all tools
  std::vector<Vec3> before;          ///< at the end of the last step; empty where no tool has friction

  /// Set-up: makes room for tools that load so many vertices each, and for which a surface that moved less
  /// than `still` (m) has not moved; the surface at rest is `free`.
  void reserve(std::span<const int> most_loads, std::span<const double> still);

  /// As the tool meets it now. Two `apply` of the model; none while the others load nothing.
  ToolTissue met_by(std::size_t tool);
  /// The loads that this tool puts on it by now.
  std::span<const NodalLoad> loads_of(std::size_t tool) const noexcept { return tools_[tool].own(); }
  /// What is kept for this tool alone.
  std::size_t bytes_of(std::size_t tool) const { return tools_[tool].pushed.size() * sizeof(Vec3); }
  /// `positions`, under the loads of now.
  void press(std::size_t tool) { positions = model->apply(tools_[tool].loads); }

 private:
  friend class ToolTissue;
  struct ToolLoads {
    std::vector<NodalLoad> loads;  // of the other tools, then its own
    std::size_t others = 0;        // how many of them are the others'
    std::span<const Vec3> free;    // the tissue's, or `pushed`
    std::vector<Vec3> pushed;      // free under the loads of the other tools; empty where there are none
    double still = 0;              // m
    std::span<const NodalLoad> own() const { return std::span(loads).subspan(others); }
  };
  bool meet(std::size_t tool);

  std::vector<ToolLoads> tools_;
};

/// The tissue as one tool meets it: free of that tool, under the loads that the others put on it when this
/// was made (`Tissue::met_by`), which are held.
class ToolTissue {
 public:
  const DeformationModel& model() const { return *tissue_.model; }
  std::span<const Vec3> free() const { return tissue_.tools_[tool_].free; }
  /// Whether that has moved, compared with the last time this tool met it.
  bool moved() const { return moved_; }
  std::span<const Vec3> positions() const { return tissue_.positions; }
  std::span<const Vec3> before() const { return tissue_.before; }

  std::span<const NodalLoad> loads() const { return tissue_.loads_of(tool_); }
  /// Replaces the loads of this tool; the tissue follows at `press`.
  void set_loads(std::span<const NodalLoad> loads);
  /// The loads of this tool on `vertices`, to be changed in place: what is there where they are on these by
  /// now, else zeros.
  std::span<NodalLoad> loads_on(std::span<const int> vertices);
  void add_load(const NodalLoad& load) { tissue_.tools_[tool_].loads.push_back(load); }
  void drop_loads() { set_loads({}); }
  /// The tissue goes where all loads press it.
  void press() { tissue_.press(tool_); }
  /// It goes free of this tool, if that loaded it.
  void release();

 private:
  friend class Tissue;
  ToolTissue(Tissue& tissue, std::size_t tool, bool moved) : tissue_(tissue), tool_(tool), moved_(moved) {}

  Tissue& tissue_;
  std::size_t tool_;
  bool moved_;
};

}  // namespace palpate::sim
