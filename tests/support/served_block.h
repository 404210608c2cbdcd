#pragma once
/// A tool on an elastic block, served in virtual time, and a law that hears of it: both programs without
/// sockets.
#include <deque>

#include "haptic_client/extrapolation/force_estimate.h"
#include "haptic_client/pipeline/pipeline.h"
#include "sim_server/mesh/shapes.h"
#include "sim_server/serving/served_tools.h"
#include "sim_server/serving/surface_pager.h"
#include "tests/support/scenes.h"

namespace palpate::test {

/// A block of 40 x 40 x 16 mm and 48 kPa, its top at y = 0 with vertices 4 mm apart, its bottom fixed, under
/// spheres of 5 mm.
inline sim::Scene block_scene(std::size_t tools = 1) {
  sim::Scene scene =
      scene_of({.young_modulus = 48e3, .poisson_ratio = 0.45}, {{-1, -0.0161, -1}, {1, -0.0159, 1}}, 0.005);
  scene.tools.resize(tools, scene.tools.front());
  return scene;
}
inline sim::TetMesh block_mesh() {
  std::vector<double> side;
  for (int i = -5; i <= 5; ++i) side.push_back(0.004 * i);
  return sim::grid_block(side, {-0.016, -0.012, -0.008, -0.004, 0}, side);
}

/// All pages of what a tool can touch.
inline std::vector<protocol::SurfacePage> all_pages(const sim::Simulation& simulation, std::size_t tool = 0) {
  sim::SurfacePager pager(simulation, tool);
  std::vector<protocol::SurfacePage> pages;
  for (protocol::SurfacePage page; pager.page(static_cast<std::uint32_t>(pages.size()), page);)
    pages.push_back(page);
  return pages;
}

/// The block steps once in each `period`; what it answers arrives `delay` later.
class ServedBlock {
 public:
  explicit ServedBlock(Time delay, std::size_t tools = 1, Time period = kPeriod)
      : ServedBlock(block_scene(tools), block_mesh(), delay, period) {}
  /// Another organ.
  ServedBlock(const sim::Scene& scene, sim::TetMesh mesh, Time delay, Time period = kPeriod)
      : simulation(scene, std::move(mesh)),
        served_(simulation),
        inputs_(scene.tools.size()),
        delay_(delay),
        period_(period) {}

  /// The newest sample that has arrived by `t`, and has not been given before; a step if one is due, of tool
  /// 0 at `p`.
  std::optional<protocol::ForceSample> exchange(Time t, const Vec3& p, const Vec3& v,
                                                Time lead = std::chrono::milliseconds(50)) {
    using protocol::ToolState;
    if (t >= due_) {
      due_ = (due_ == Time{} ? t : due_) + period_;
      ToolState state{.tick = ++ticks_, .t_ns = t.count(), .p_W = p, .v_W = v, .lead_ns = lead.count()};
      state.flags = ToolState::kRequestsTangent | ToolState::kRequestsAhead | ToolState::kRequestsSurface;
      inputs_.front() = {7, state, true};
      const auto outcomes = served_.step(inputs_, to_seconds(period_));
      in_transit_.push_back({t + delay_, outcomes.front().answer.value()});
    }
    std::optional<protocol::ForceSample> newest;
    for (; !in_transit_.empty() && in_transit_.front().first <= t; in_transit_.pop_front())
      newest = in_transit_.front().second;
    return newest;
  }
  void hold_second_tool(const Vec3& p) { inputs_[1] = {8, {.tool = 1, .tick = ++ticks_, .p_W = p}, true}; }
  void set_delay(Time delay) { delay_ = delay; }

  static constexpr Time kPeriod = std::chrono::microseconds(30030);  // 33.3 Hz
  sim::Simulation simulation;

 private:
  sim::ServedTools served_;
  std::vector<sim::SessionInput> inputs_;
  Time delay_, period_, due_{};
  std::uint64_t ticks_ = 0;
  std::deque<std::pair<Time, protocol::ForceSample>> in_transit_;
};

}  // namespace palpate::test
