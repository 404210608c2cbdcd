#include "sim_server/commands/live_view.h"

#include <algorithm>

#include "common/clock.h"
#include "protocol/udp_socket.h"

namespace palpate::sim {
namespace {

constexpr Time kPictureEach = std::chrono::milliseconds(15);  // at most

void flag_all(std::vector<std::uint8_t>& flags, const std::vector<int>& vertices, std::uint8_t flag) {
  for (const int v : vertices) flags[static_cast<std::size_t>(v)] |= flag;
}

OrganShape shape_of(const Scene& scene, const Simulation& simulation) {
  const Surface& surface = simulation.surface();
  OrganShape organ{simulation.rest(), surface.triangles, std::vector<std::uint8_t>(surface.vertices.size())};
  const std::vector<int> fixed = fixed_vertices(scene, simulation.mesh());
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    if (std::ranges::binary_search(fixed, surface.vertices[v])) organ.flags[v] |= OrganShape::kFixed;
  }
  for (std::size_t i = 0; i < simulation.tools(); ++i) {
    for (const Triangle& triangle : simulation.touchable(i))
      flag_all(organ.flags, {triangle[0], triangle[1], triangle[2]}, OrganShape::kInReach);
  }
  return organ;
}

void copy_loads(std::span<const NodalLoad> loads, SeenTool& seen) noexcept {
  seen.load_count = std::min(loads.size(), SeenTool::kMostLoads);
  for (std::size_t k = 0; k < seen.load_count; ++k) {
    seen.loads[k].vertex = static_cast<std::uint32_t>(loads[k].vertex);
    for (int i = 0; i < 3; ++i) seen.loads[k].force[i] = static_cast<float>(loads[k].force[i]);
  }
}

}  // namespace

SceneFacts facts_of(const Scene& scene, const Simulation& simulation) {
  SceneFacts facts{.title = scene.title,
                   .file = scene.source,
                   .model = scene.deformation.model,
                   .rate_hz = scene.rate_hz,
                   .tools = {},
                   .organ = shape_of(scene, simulation)};
  for (const ToolSettings& tool : scene.tools) facts.tools.push_back(tool.shape);
  return facts;
}

LiveView::LiveView(const ViewerAddress& address, std::string token, SceneFacts facts,
                   const Simulation& simulation, Time began)
    : simulation_(simulation),
      facts_(std::move(facts)),
      token_(std::move(token)),
      feed_(facts_.organ.rest),
      viewer_(address, token_, facts_, feed_),
      began_(began) {}

std::string LiveView::link() const {
  return "http://" + protocol::to_string(viewer_.endpoint()) + "/" +
         (token_.empty() ? "" : "#token=" + token_);
}

bool LiveView::may_step() noexcept {
  if (!feed_.paused.load(std::memory_order_relaxed)) return true;
  int left = feed_.steps.load(std::memory_order_relaxed);
  return left > 0 && feed_.steps.compare_exchange_strong(left, left - 1, std::memory_order_relaxed);
}

void LiveView::turned(const LoopTurn& turn) noexcept {
  if (!turn.outcomes.empty()) {
    ++newest_.step;
    newest_.simulated += turn.dt;
    owed_ = true;
  }
  const int pages = feed_.pages.load(std::memory_order_relaxed);
  if (pages == 0) {
    pages_ = 0;
    return;
  }
  note(turn);
  const Time time = now();
  if ((!owed_ && pages == pages_) || time - shown_ < kPictureEach) return;
  pages_ = pages;
  shown_ = time;
  owed_ = false;
  fill(feed_.pictures.back());
  feed_.pictures.publish();
  viewer_.ring();
}

/// What came of this step, for the picture that shows it.
void LiveView::note(const LoopTurn& turn) noexcept {
  newest_.late = turn.late;
  newest_.t = to_seconds(now() - began_);
  for (std::size_t i = 0; i < turn.inputs.size(); ++i) {
    const SessionInput& input = turn.inputs[i];
    SeenTool& seen = newest_.tools[i];
    const bool lost = (input.state.flags & protocol::ToolState::kDeviceLost) != 0;
    owed_ = owed_ || seen.held != (input.session != 0 && !lost);
    seen.held = input.session != 0 && !lost;
    if (seen.held) seen.pose = pose_of(input.state);
    if (turn.outcomes.empty()) continue;
    newest_.step_ms = 1e3 * to_seconds(turn.took);
    const auto& [force, answer] = turn.outcomes[i];
    seen.contact = force.contacts > 0;
    seen.flagged = force.flagged;
    seen.f_W = force.force;
    if (answer)
      seen.sample = {answer->number, newest_.t, static_cast<float>(force.force.norm()), answer->flags};
  }
}

void LiveView::fill(Picture& picture) noexcept {
  std::size_t k = 0;
  for (const Vec3& p : simulation_.positions()) {
    for (int i = 0; i < 3; ++i) picture.positions[k++] = static_cast<float>(p[i]);
  }
  picture.t = newest_.t;
  picture.step = newest_.step;
  picture.simulated = newest_.simulated;
  picture.step_ms = newest_.step_ms;
  picture.late = newest_.late;
  for (std::size_t i = 0; i < simulation_.tools(); ++i) {
    copy_loads(simulation_.loads(i), newest_.tools[i]);
    picture.tools[i] = newest_.tools[i];
  }
}

}  // namespace palpate::sim
