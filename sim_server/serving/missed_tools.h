#pragma once
#include <algorithm>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <vector>

#include "sim_server/serving/served_tools.h"

namespace palpate::sim {

/// Measures by how much tools miss the tissue, for whoever never touches it: ten times a second until a tool
/// first touches.
class MissedTools {
 public:
  explicit MissedTools(std::size_t tools = 0) : tools_(tools) {}

  /// After a step at `t`, on any clock. O(vertices) for each tool that has not touched yet, no allocation.
  void measure(std::span<const ServedTools::Outcome> outcomes, const Simulation& simulation,
               Time t) noexcept {
    for (std::size_t i = 0; i < outcomes.size(); ++i)
      tools_[i].touched = tools_[i].touched || outcomes[i].force.contacts > 0;
    if (t < next_) return;
    next_ = t + kPeriod;
    for (std::size_t i = 0; i < tools_.size(); ++i) {
      if (tools_[i].touched) continue;
      if (const auto gap = simulation.gap(i))
        tools_[i].nearest = std::min(tools_[i].nearest.value_or(*gap), *gap);
    }
  }
  /// Smallest distance of a tool from the surface that it can touch, m; nothing for one that touched it, or
  /// that nobody held.
  std::optional<double> missed_by(std::size_t tool) const {
    return tools_[tool].touched ? std::nullopt : tools_[tool].nearest;
  }

 private:
  static constexpr Time kPeriod = std::chrono::milliseconds(100);
  struct Tool {
    bool touched = false;
    std::optional<double> nearest{};  // m
  };
  std::vector<Tool> tools_;
  Time next_{};
};

/// "tool 1 never touched the organ: it came within 12.3 mm of it"; `missed_by` in m.
inline std::string never_touched_text(std::size_t tool, double missed_by) {
  return fmt::format("tool {} never touched the organ: it came within {:.1f} mm of it", tool + 1,
                     1e3 * missed_by);
}

}  // namespace palpate::sim
