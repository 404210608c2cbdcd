#include "sim_server/contact/tissue.h"

#include <algorithm>
#include <numeric>

#include "sim_server/contact/surface_change.h"

namespace palpate::sim {
namespace {

// Of the tool radius: a surface that moved less did not move; and what was not near when contact was solved,
// so half a radius from touching, does not touch before others have pushed it by more than that.
constexpr double kUnmoved = 1e-8, kFar = 0.25;

double move_of(std::span<const Vec3> from, std::span<const Vec3> to, std::size_t vertex) noexcept {
  return (to[vertex] - from[vertex]).cwiseAbs().maxCoeff();
}

double largest_move(std::span<const Vec3> from, std::span<const Vec3> to) noexcept {
  double largest = 0;
  for (std::size_t v = 0; v < from.size(); ++v) largest = std::max(largest, move_of(from, to, v));
  return largest;
}

double largest_move(std::span<const Vec3> from, std::span<const Vec3> to, std::span<const int> of) noexcept {
  double largest = 0;
  for (const int v : of) largest = std::max(largest, move_of(from, to, static_cast<std::size_t>(v)));
  return largest;
}

}  // namespace

void Tissue::reserve(std::span<const int> most_loads, std::span<const double> radii) {
  const auto all = static_cast<std::size_t>(std::accumulate(most_loads.begin(), most_loads.end(), 0));
  tools_.resize(most_loads.size());
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    tools_[i].loads.reserve(all);
    tools_[i].free = free;
    tools_[i].radius = radii[i];
    tools_[i].touched.reserve(static_cast<std::size_t>(most_loads[i]));
    if (tools_.size() > 1) tools_[i].pushed.assign(free.begin(), free.end());
    for (auto* const array :
         {&tools_[i].solved, &tools_[i].shift, &tools_[i].positions_at, &tools_[i].free_at})
      array->assign(free.begin(), free.end());
  }
}

void Tissue::change_surface(const SurfaceChange& change) {
  for (ToolLoads& tool : tools_) {
    std::vector<VertexLoad> own(tool.own().begin(), tool.own().end());
    tool.loads.resize(tool.others);
    change.apply_to(tool.loads);
    change.apply_to(own);
    tool.others = tool.loads.size();
    tool.loads.insert(tool.loads.end(), own.begin(), own.end());
  }
}

void Tissue::separate(std::size_t tool) noexcept {
  ToolLoads& mine = tools_[tool];
  mine.loads.clear();
  mine.others = 0;
  mine.remaining = 0;
}

Tissue::State Tissue::save() const {
  State state{before, tools_, moved_ != nullptr, motions_};
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    const bool is_pushed = tools_[i].free.data() == tools_[i].pushed.data();
    state.tools[i].free = is_pushed ? std::span<const Vec3>(state.tools[i].pushed) : std::span<const Vec3>();
  }
  return state;
}

void Tissue::restore(const State& state, const FreeMotion& motion) {
  free = motion.positions;
  velocities = motion.velocities;
  carried = motion.carried;
  positions = motion.loaded.empty() ? motion.positions : motion.loaded;
  before = state.before;
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    tools_[i] = state.tools[i];
    tools_[i].free = state.tools[i].free.empty() ? free : std::span<const Vec3>(tools_[i].pushed);
  }
  moved_ = state.knows_moved ? motion.moved : nullptr;
  motions_ = state.motions;
}

ToolTissue Tissue::touched_by(std::size_t tool) {
  return {*this, tool, touches(tool)};
}

/// Takes over the loads that the other tools put on the tissue by now. Returns whether that moved what is
/// free to this tool.
bool Tissue::touches(std::size_t tool) {
  ToolLoads& mine = tools_[tool];
  const auto loaded = [&](const ToolLoads& other) { return &other != &mine && !other.own().empty(); };
  if (mine.others == 0 && std::ranges::none_of(tools_, loaded)) {
    mine.free = free;
    return false;
  }
  take_loads_of_others(mine);
  positions = model->apply(std::span(mine.loads).first(mine.others));
  const bool moved = push(mine);
  if (!mine.own().empty()) apply_loads(tool);
  return moved;
}

void Tissue::take_loads_of_others(ToolLoads& mine) {
  auto& loads = mine.loads;
  loads.erase(loads.begin(), loads.begin() + static_cast<long>(mine.others));
  const std::size_t own = loads.size();
  for (const ToolLoads& other : tools_) {
    if (&other == &mine || other.own().empty()) continue;
    const auto theirs = other.own();
    loads.insert(loads.end(), theirs.begin(), theirs.end());
  }
  mine.others = loads.size() - own;
  std::rotate(loads.begin(), loads.begin() + static_cast<long>(own), loads.end());
}

ToolTissue Tissue::known_to(std::size_t tool) {
  return {*this, tool, false};
}

void Tissue::replace_loads(std::size_t tool, std::span<const VertexLoad> loads) {
  auto& mine = tools_[tool];
  mine.loads.erase(mine.loads.begin() + static_cast<long>(mine.others), mine.loads.end());
  mine.loads.insert(mine.loads.end(), loads.begin(), loads.end());
}

void Tissue::apply_all_loads() {
  for (ToolLoads& tool : tools_) take_loads_of_others(tool);
  apply_loads(0);
  for (ToolLoads& tool : tools_) put_on_way(tool);
}

/// The surface as a tool meets it that still has some of the way to come.
void Tissue::put_on_way(ToolLoads& mine) {
  for (std::size_t v = 0; mine.remaining > 0 && v < mine.shift.size(); ++v)
    mine.positions_at[v] = positions[v] - mine.remaining * mine.shift[v];
}

Vec3 ToolTissue::still_to_come(int vertex) const noexcept {
  const auto& mine = tissue_.tools_[tool_];
  return mine.remaining > 0 ? Vec3(mine.remaining * mine.shift[static_cast<std::size_t>(vertex)])
                            : Vec3(Vec3::Zero());
}

/// Pushes what is free to this tool to `positions`, if that moves it. Returns whether what matters to it
/// moves.
bool Tissue::push(ToolLoads& tool) {
  const bool was_pushed = tool.free.data() == tool.pushed.data();
  const bool some = was_pushed && moved_ != nullptr && tool.pushed_in + 1 >= motions_;
  const double most = some ? largest_move(tool.free, positions, *moved_) : largest_move(tool.free, positions);
  const double touched = tool.touched_any ? most : largest_move(tool.free, positions, tool.touched);
  const bool moved = most > kUnmoved * tool.radius;
  for (std::size_t k = 0; some && moved && k < moved_->size(); ++k) {
    const auto v = static_cast<std::size_t>((*moved_)[k]);
    tool.pushed[v] = positions[v];
  }
  if (!some && (moved || !was_pushed)) std::ranges::copy(positions, tool.pushed.begin());
  tool.free = tool.pushed;
  tool.pushed_in = motions_;
  tool.went += most;
  return touched > kUnmoved * tool.radius || tool.went > kFar * tool.radius;
}

std::span<const Vec3> ToolTissue::free() const {
  const auto& mine = tissue_.tools_[tool_];
  return mine.remaining > 0 ? std::span<const Vec3>(mine.free_at) : mine.free;
}

std::span<const Vec3> ToolTissue::positions() const {
  const auto& mine = tissue_.tools_[tool_];
  return mine.remaining > 0 ? std::span<const Vec3>(mine.positions_at) : tissue_.positions;
}

void ToolTissue::apply_loads() {
  tissue_.apply_loads(tool_);
  tissue_.put_on_way(tissue_.tools_[tool_]);
}

void Tissue::set_free(const FreeMotion& motion) noexcept {
  free = motion.positions;
  velocities = motion.velocities;
  carried = motion.carried;
  if (!motion.loaded.empty()) positions = motion.loaded;
  moved_ = motion.moved;
  ++motions_;
}

/// Returns what may have moved since a tool's contact was last solved; empty: any may have.
std::span<const int> Tissue::moved_since(const ToolLoads& tool) const noexcept {
  const bool of_one_motion = tool.solved_in + 1 >= motions_ && tool.carried.isZero(0);
  return of_one_motion && moved_ != nullptr ? std::span<const int>(*moved_) : std::span<const int>();
}

void Tissue::start_step() noexcept {
  for (ToolLoads& tool : tools_) tool.looked_in = 0;
}

std::span<const int> ToolTissue::moved_since_search() noexcept {
  auto& mine = tissue_.tools_[tool_];
  const bool known = tissue_.moved_ != nullptr && mine.remaining == 0 && mine.looked_in > 0 &&
                     mine.looked_in + 1 >= tissue_.motions_;
  mine.looked_in = mine.remaining == 0 ? tissue_.motions_ : 0;
  return known ? std::span<const int>(*tissue_.moved_) : std::span<const int>();
}

void Tissue::note_same_place() noexcept {
  for (ToolLoads& tool : tools_) std::ranges::copy(positions, tool.solved.begin());
  if (!before.empty()) std::ranges::copy(positions, before.begin());
}

void Tissue::note_shift(ToolLoads& tool, std::span<const Vec3> positions, std::size_t vertex) noexcept {
  tool.shift[vertex] = positions[vertex] - tool.solved[vertex] - tool.carried;
}

double ToolTissue::surface_motion(const Vec3& p, const Vec3& q, double reach) {
  auto& mine = tissue_.tools_[tool_];
  const Vec3 axis = q - p;
  const double length2 = axis.squaredNorm();
  double most = 0;
  const auto observe = [&](std::size_t v) {
    Tissue::note_shift(mine, tissue_.positions, v);
    const double went = mine.shift[v].norm();
    if (went <= most) return;
    const Vec3 from = tissue_.positions[v] - mine.shift[v];
    const double along = length2 > 0 ? std::clamp((from - p).dot(axis) / length2, 0.0, 1.0) : 0;
    if ((from - p - along * axis).norm() - went < reach) most = went;
  };
  const std::span<const int> moved = tissue_.moved_since(mine);
  mine.shift_of_moved = !moved.empty();
  for (const int v : moved) observe(static_cast<std::size_t>(v));
  for (std::size_t v = 0; moved.empty() && v < mine.shift.size(); ++v) observe(v);
  return most;
}

void ToolTissue::set_remaining_fraction(double remaining) {
  auto& mine = tissue_.tools_[tool_];
  mine.remaining = remaining;
  if (remaining == 0) return;
  for (std::size_t v = 0; mine.shift_of_moved && v < mine.shift.size(); ++v)
    Tissue::note_shift(mine, tissue_.positions, v);
  mine.shift_of_moved = false;
  for (std::size_t v = 0; v < mine.shift.size(); ++v) {
    mine.positions_at[v] = tissue_.positions[v] - remaining * mine.shift[v];
    mine.free_at[v] = mine.free[v] - remaining * mine.shift[v];
  }
}

void ToolTissue::mark_solved() noexcept {
  auto& mine = tissue_.tools_[tool_];
  const std::span<const int> moved = tissue_.moved_since(mine);
  for (const int v : moved)
    mine.solved[static_cast<std::size_t>(v)] = tissue_.positions[static_cast<std::size_t>(v)];
  if (moved.empty()) std::ranges::copy(tissue_.positions, mine.solved.begin());
  mine.remaining = 0;
  mine.carried.setZero();
  mine.solved_in = tissue_.motions_;
  mine.touched_any = true;
  mine.went = 0;
}

void ToolTissue::mark_solved(std::span<const int> touched) noexcept {
  mark_solved();
  auto& mine = tissue_.tools_[tool_];
  mine.touched_any = touched.size() > mine.touched.capacity();
  if (!mine.touched_any) mine.touched.assign(touched.begin(), touched.end());
}

void ToolTissue::set_loads(std::span<const VertexLoad> loads) {
  tissue_.replace_loads(tool_, loads);
}

void ToolTissue::release() {
  if (loads().empty()) return;
  drop_loads();
  apply_loads();
}

std::span<VertexLoad> ToolTissue::loads_on(std::span<const int> vertices) {
  auto& mine = tissue_.tools_[tool_];
  const auto same = [](const VertexLoad& load, int vertex) { return load.vertex == vertex; };
  const auto own = mine.own();
  if (!std::equal(own.begin(), own.end(), vertices.begin(), vertices.end(), same)) {
    drop_loads();
    for (const int vertex : vertices) add_load({vertex, Vec3::Zero()});
  }
  return std::span(mine.loads).subspan(mine.others);
}

}  // namespace palpate::sim
