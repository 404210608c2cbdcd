#include "sim_server/simulation/simulation.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <new>
#include <numeric>

#include "common/error.h"
#include "common/hash.h"
#include "common/text.h"
#include "sim_server/elasticity/solid.h"
#include "sim_server/mesh/bounding_box.h"
#include "sim_server/mesh/gmsh_io.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/scene/held_motion.h"
#include "sim_server/scene/inclusions.h"
#include "sim_server/scene/touchable.h"
#include "sim_server/simulation/set_up_memory.h"

namespace palpate::sim {
namespace {

constexpr std::size_t kSpacing = 2;   // instants: how far apart those are that tell where a tool goes on to
constexpr double kLongestLead = 0.5;  // of the tool radius: how far ahead of itself a tool is believed to be
constexpr int kLateParts = 4;  // of a step: over the last of so many parts chattering forces are averaged
constexpr double kAnywhere = 1e150;  // m
constexpr double kRunAway = 3;       // of the organ's size: farther from rest no tissue goes

/// The surface vertices that are these vertices of the mesh; both ascending.
std::vector<int> on_surface(std::span<const int> vertices, const Surface& surface) {
  std::vector<int> found;
  for (int v = 0; v < static_cast<int>(surface.vertices.size()); ++v) {
    if (std::ranges::binary_search(vertices, surface.vertices[v])) found.push_back(v);
  }
  return found;
}

/// Triangles of the surface that each tool can touch; one of the tools at least can touch some.
std::vector<std::vector<Triangle>> some_touchable(const Scene& scene, const Surface& surface,
                                                  const TetMesh& mesh) {
  auto touchable = touchable_by(scene.tools, surface, mesh);
  if (std::ranges::all_of(touchable, [](const auto& list) { return list.empty(); }))
    fail("{}: no triangle of the surface lies within the tool's reach", scene.tools.front().reach_where);
  return touchable;
}

/// Each tool of the scene, on an organ of which the vertices `held` are held to something.
std::vector<ToolContact> make_tools(const Scene& scene, std::span<const Vec3> rest, const Surface& surface,
                                    std::vector<std::vector<Triangle>> touchable, std::span<const int> held,
                                    const Progress& progress) {
  std::vector<ToolContact> tools;
  tools.reserve(scene.tools.size());
  for (std::size_t i = 0; i < scene.tools.size(); ++i) {
    const std::string stage = contact_stage(i, scene.tools.size());
    progress(stage, 0);
    tools.emplace_back(scene.tools[i], rest, surface, std::move(touchable[i]), held,
                       scene.cutting.has_value());
    progress(stage, 1);
  }
  return tools;
}

/// The tissue gets room for what these tools load. Returns how many loads all of them have at most.
std::size_t make_room_for_loads(const std::vector<ToolContact>& tools, Tissue& tissue) {
  std::vector<int> most_loads;
  std::vector<double> radii;
  for (const ToolContact& tool : tools) {
    most_loads.push_back(tool.max_nodes());
    radii.push_back(tool.radius());
  }
  tissue.reserve(most_loads, radii);
  if (std::ranges::any_of(tools, [](const ToolContact& tool) { return tool.has_friction(); }))
    tissue.before.assign(tissue.positions.begin(), tissue.positions.end());
  return static_cast<std::size_t>(std::accumulate(most_loads.begin(), most_loads.end(), 0));
}

/// Halves the last force each step once the solution is lost.
void fade(ToolForce& force) noexcept {
  force.force *= 0.5;
  force.torque *= 0.5;
  force.tangent.setZero();
  force.flagged = true;
}

/// Supports that carry tissue and tool along make neither slip on the other; what the tissue does besides, as
/// it swings, does.
void carry_before(Tissue& tissue, double dt) noexcept {
  if (tissue.velocities.empty()) return;
  for (std::size_t v = 0; v < tissue.before.size(); ++v) tissue.before[v] += dt * tissue.velocities[v];
}

/// Reads the mesh and reports that to `progress`.
TetMesh read_mesh_with(const Scene& scene, const Progress& progress) {
  progress(name_of(Stage::kMesh), 0);
  return read_mesh_of(scene);
}

}  // namespace

std::string contact_part(std::size_t tool, std::size_t tools) {
  return tools == 1 ? "contact" : fmt::format("contact of tool {}", tool + 1);
}

std::string contact_stage(std::size_t tool, std::size_t tools) {
  return "preparing " + contact_part(tool, tools);
}

Simulation::Simulation(const Scene& scene, const Progress& progress, const SetupCache* cache,
                       const Condensed* condensed)
    : Simulation(scene, read_mesh_with(scene, progress), progress, cache, condensed) {}

Simulation::Simulation(const Scene& scene, TetMesh mesh, const Progress& progress, const SetupCache* cache,
                       const Condensed* condensed) {
  organ_.mesh = std::make_unique<TetMesh>(std::move(mesh));
  put_inclusions(scene, *organ_.mesh);
  progress(name_of(Stage::kSurface), 0);
  if (scene.material) *organ_.mesh = with_nodes(std::move(*organ_.mesh), scene.material->element);
  organ_.surface = boundary_surface(*organ_.mesh);
  const std::vector<int> fixed = fixed_vertices(scene, *organ_.mesh);
  std::vector<int> at_rest = fixed;
  if (scene.cutting) {
    cut_.emplace(scene, *organ_.mesh, fixed, organ_.surface);
    const auto [spare, end] = cut_->resection().remaining().spares();
    for (int v = spare; v < end; ++v) at_rest.push_back(v);
  }
  for (const int vertex : organ_.surface.vertices) organ_.rest.push_back(organ_.mesh->vertices[vertex]);
  auto touchable = some_touchable(scene, organ_.surface, *organ_.mesh);
  const std::vector<int> reachable = vertices_of(touchable);
  require_memory_for(scene, Purpose::kServe, count_parts(*organ_.mesh, organ_.surface));
  const DeformationModelRow& row = model_of(scene.deformation);
  if (row.deforms() && !fixed.empty() && !supports_move(scene))
    organ_.furthest = kRunAway * diagonal_of(organ_.rest);
  tissue_.model = row.make(
      {scene, *organ_.mesh, organ_.surface, at_rest, reachable, progress, free_memory(), cache, condensed});
  tissue_.traits = tissue_.model->traits();
  const FreeMotion motion = tissue_.model->free_motion(0);
  tissue_.free = tissue_.positions = motion.positions;
  tissue_.velocities = motion.velocities;
  const std::vector<int> held = on_surface(fixed, organ_.surface);
  tools_ = make_tools(scene, tissue_.free, organ_.surface, std::move(touchable), held, progress);
  const std::size_t all_loads = make_room_for_loads(tools_, tissue_);
  if (tools_.size() > 1) {
    coupling_.emplace(tools_.size(), organ_.rest.size(), all_loads);
    joint_.emplace(tools_, organ_.rest.size());
    grips_.emplace(tools_);
  }
  tracks_.resize(tools_.size());
  for (Track& track : tracks_) track.recent.reserve(2 * kSpacing + 1);
  make_room_for_modes();
  places_.reserve(tools_.size());
  inputs_.resize(tools_.size());
  answers_.resize(tools_.size());
}

void Simulation::make_room_for_modes() {
  const PublishedModes* const modes = published_modes();
  if (modes == nullptr) return;
  ModalMotion& room = published_.modes;
  room.q = room.v = Eigen::VectorXd::Zero(modes->published);
  room.z.setZero(modes->published, static_cast<Eigen::Index>(modes->relaxations.size()));
  room.psi.assign(organ_.rest.size() * modes->relaxations.size(), Vec3::Zero());
  for (Track& track : tracks_) track.modal_loads = room.q;
  pair_.reserve(2, 0);
  pair_.free.resize(2);
}

const PublishedModes* Simulation::published_modes() const noexcept {
  const PublishedModes* const modes = tissue_.traits.client ? tissue_.traits.client->modes() : nullptr;
  const bool published =
      modes != nullptr && modes->published > 0 && (tools_.size() == 1 || modes->relaxations.empty());
  return published ? modes : nullptr;
}

std::shared_ptr<const PublishedSurface> Simulation::published_surface() const noexcept {
  return cut_ ? cut_->published() : nullptr;
}

void Simulation::set_cut_options(CutOptions options) {
  if (cut_) cut_->set_options(std::move(options));
}

bool Simulation::balanced() const noexcept {
  const NonlinearModel* const nonlinear = tissue_.traits.nonlinear;
  return nonlinear == nullptr || nonlinear->balance() == NonlinearModel::Balance::kBalanced;
}

std::span<const Vec3> Simulation::nodes() const noexcept {
  return tissue_.traits.interior ? tissue_.traits.interior->nodes() : std::span<const Vec3>();
}

std::span<const ToolAnswer> Simulation::step(std::span<const ToolInput> inputs, double dt) noexcept {
  assert(inputs.size() == tools_.size());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (inputs[i].enters) separate_tool(i);
  }
  try {
    advance(inputs, dt);
    status_.failed = false;
  } catch (const std::bad_alloc&) {
    ++counts_.failures.out_of_memory;
    hold_answers(inputs);
  } catch (...) {
    ++counts_.failures.other;
    hold_answers(inputs);
  }
  count_flagged();
  return answers_;
}

void Simulation::count_flagged() noexcept {
  if (std::ranges::none_of(answers_, &ToolAnswer::flagged)) return;
  using Balance = NonlinearModel::Balance;
  const NonlinearModel* const nonlinear = tissue_.traits.nonlinear;
  const Balance balance = nonlinear ? nonlinear->balance() : Balance::kBalanced;
  FlaggedSteps& flagged = counts_.flagged;
  std::uint64_t& reason = status_.failed                    ? flagged.threw
                          : status_.ran_away                ? flagged.ran_away
                          : balance == Balance::kInsideOut  ? flagged.inside_out
                          : balance == Balance::kUnbalanced ? flagged.not_balanced
                          : !status_.tools_settled          ? flagged.tools
                                                            : flagged.contact;
  ++reason;
}

/// Holds the answers after a step that threw. The forces of a tissue that answers no more fade.
void Simulation::hold_answers(std::span<const ToolInput> inputs) noexcept {
  for (std::size_t i = 0; i < answers_.size(); ++i) {
    ToolForce held = inputs[i].pose ? answers_[i] : ToolForce{};
    if (status_.failed) fade(held);
    held.tangent.setZero();
    held.flagged = inputs[i].pose.has_value();
    answers_[i] = {};
    static_cast<ToolForce&>(answers_[i]) = held;
  }
  status_.failed = true;
}

void Simulation::advance(std::span<const ToolInput> inputs, double dt) {
  for (Track& track : tracks_) {
    track.mean.setZero();
    track.late_mean.setZero();
  }
  tissue_.start_step();
  if (joint_) joint_->forget();
  if (cut_ && cut_->start_step(inputs, status_.time, dt, cut_organ())) {
    ++published_.version;
    make_room_for_modes();
  }
  for (std::size_t i = 0; i < tools_.size(); ++i) tools_[i].set_buttons(inputs[i].buttons);
  if (tissue_.traits.cuttable != nullptr && instants() > 1) restrict_contact(inputs);
  for (int instant = 1; instant <= instants(); ++instant)
    advance_to_instant(inputs, instant, dt / instants());
  for (std::size_t i = 0; i < tools_.size(); ++i) tracks_[i].from = inputs[i].pose;
  status_.ran_away = ran_away();
  for (std::size_t i = 0; i < tools_.size(); ++i) answer(i, inputs[i], dt);
  if (cut_) cut_->end_step(inputs, status_.time, dt, tools_, answers_);
  status_.time += dt;
  couple(inputs);
  for (std::size_t i = 0; i < tools_.size(); ++i) add_wanted(i, inputs[i]);
}

/// Sets the force on a tool.
void Simulation::answer(std::size_t tool, const ToolInput& input, double dt) {
  ToolContact& contact = tools_[tool];
  ToolAnswer& answer = answers_[tool];
  const ToolForce before = answer;
  answer = {};
  static_cast<ToolForce&>(answer) = before;
  if (status_.ran_away && contact.placed()) return fade(answer);
  if (instants() > 1)
    contact.predict_tangent(std::max(dt, input.request.ahead ? input.request.ahead->seconds : 0));
  const bool publishes_tangents = tissue_.traits.publishes_tangents;
  if (input.request.tangent && publishes_tangents) differentiate(tool);
  static_cast<ToolForce&>(answer) = contact.force();
  if (!publishes_tangents) answer.force = tracks_[tool].late_mean;
  answer.mean_force = tracks_[tool].mean;
  if (cut_) cut_->resist(tool, contact, dt, answer);
}

void Simulation::differentiate(std::size_t tool) {
  if (joint_ && joint_->has_solved(tool))
    return joint_->differentiate(tool, tools_[tool], tissue_.known_to(tool));
  tools_[tool].differentiate(tissue_.touched_by(tool));
}

/// Returns where contact is solved at an instant of a step: where the tool is then, or, where the model's
/// force leads, will be at the next; after the last, going on along the parabola through where it was lately.
PathPoint Simulation::contact_point(std::size_t tool, const ToolInput& input, int instant) const {
  if (!tissue_.traits.leading_force) return at_instant(tool, input, instant);
  if (instant < instants()) return at_instant(tool, input, instant + 1);
  PathPoint point = at_instant(tool, input, instant);
  const std::vector<ToolPose>& were = tracks_[tool].recent;  // the newest first: this one
  const std::size_t spacing = std::min<std::size_t>(kSpacing, (were.size() - 1) / 2);
  if (spacing == 0) return point;
  const Vec3 &now = were[0].p_W, &before = were[spacing].p_W, &first = were[2 * spacing].p_W;
  const auto n = static_cast<double>(spacing);
  const Vec3 bend = (now - 2 * before + first) / (n * n), motion = (now - before) / n + (n + 1) / 2 * bend;
  if (motion.norm() <= kLongestLead * tools_[tool].radius()) point.pose.p_W += motion;
  const double turn =
      were[0].q_W.angularDistance(were[1].q_W) * std::max(tools_[tool].shape().length, tools_[tool].radius());
  if (turn <= kLongestLead * tools_[tool].radius())
    point.pose.q_W = (were[0].q_W * were[1].q_W.conjugate() * were[0].q_W).normalized();
  return point;
}

void Simulation::add_recent(std::size_t tool, const ToolPose& pose) {
  std::vector<ToolPose>& were = tracks_[tool].recent;
  if (were.size() > 2 * kSpacing) were.pop_back();
  were.insert(were.begin(), pose);
}

/// Returns where a tool is at an instant of a step, from 1 to the last.
PathPoint Simulation::at_instant(std::size_t tool, const ToolInput& input, int instant) const {
  const bool last = input.path.size() + 1 == static_cast<std::size_t>(instants());
  if (instant == instants()) return {*input.pose, last ? input.bend : Bend{}};
  if (last) return input.path[static_cast<std::size_t>(instant) - 1];
  if (!tracks_[tool].from) return {*input.pose};  // it appears there
  const double fraction = static_cast<double>(instant) / instants();
  const ToolPose &from = *tracks_[tool].from, &to = *input.pose;
  return {ToolPose((1 - fraction) * from.p_W + fraction * to.p_W, from.q_W.slerp(fraction, to.q_W))};
}

/// The tissue goes on by `dt` (s), then contact is solved with the tools where they are by then.
void Simulation::advance_to_instant(std::span<const ToolInput> inputs, int instant, double dt) {
  move_organ(dt);
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    if (!inputs[i].pose) separate_tool(i);
    if (tools_.size() > 1) tools_[i].keep(tissue_.loads_of(i));
  }
  std::array<std::optional<PathPoint>, kMaxTools> to;
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    if (!inputs[i].pose) continue;
    if (tissue_.traits.leading_force) add_recent(i, at_instant(i, inputs[i], instant).pose);
    to[i] = contact_point(i, inputs[i], instant);
  }
  status_.tools_settled = true;
  advance_tools(std::span(to).first(tools_.size()));
  solve_contacts();
  if (!status_.tools_settled) restore_touching();
  if (!tissue_.before.empty()) std::ranges::copy(tissue_.positions, tissue_.before.begin());
  const int late = (instants() + kLateParts - 1) / kLateParts;
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    tracks_[i].mean += tools_[i].force().force / instants();
    if (instant > instants() - late) tracks_[i].late_mean += tools_[i].force().force / late;
  }
}

/// Contact again where a linearisation about where it led says something else. Where no
/// more contact is to be found in this step, the body is still brought to balance with the last.
void Simulation::solve_contacts() {
  bool found = true;
  NonlinearModel* const nonlinear = tissue_.traits.nonlinear;
  if (nonlinear == nullptr) return;
  while (const auto motion = nonlinear->relinearise()) {
    tissue_.set_free(*motion);
    found = found && std::ranges::none_of(tools_, &ToolContact::exhausted);
    if (!found) continue;
    settle();
  }
  if (!found || !balanced()) flag_contacts();
}

/// True if some of the surface is at no finite place, or beyond any that an organ that is held can get to.
bool Simulation::ran_away() const noexcept {
  const bool loose = cut_ && cut_->resection().totals().loose_pieces > 0;  // these may go anywhere
  const double most = loose ? kAnywhere * kAnywhere : organ_.furthest * organ_.furthest;
  const auto is_near = [&](std::size_t v) {  // false of what is not a number, too
    return (tissue_.positions[v] - organ_.rest[v]).squaredNorm() <= most;
  };
  bool near = true;
  if (!cut_) {
    for (std::size_t v = 0; v < organ_.rest.size(); ++v) near &= is_near(v);
    return !near;
  }
  const CutMesh& remaining = cut_->resection().remaining();
  for (std::size_t v = 0; v < organ_.rest.size(); ++v)
    near &= !remaining.on_surface(static_cast<int>(v)) || is_near(v);
  return !near;
}

/// The tools stay where they were on the organ, which goes by the mean of its velocities before and after
/// (exact to the third order in `dt`): one that stands on a surface coming towards it is not left behind
/// inside. From there they walk to where they are now.
void Simulation::move_organ(double dt) {
  const bool moves = !tissue_.velocities.empty();
  for (std::size_t i = 0; moves && i < tools_.size(); ++i)
    tracks_[i].surface_motion =
        0.5 * dt *
        tools_[i].surface_velocity(tools_[i].place(), tissue_, tissue_.velocities, tissue_.loads_of(i));
  carry_before(tissue_, 0.5 * dt);
  tissue_.set_free(tissue_.model->free_motion(dt));
  carry_before(tissue_, 0.5 * dt);
  for (std::size_t i = 0; moves && i < tools_.size(); ++i)
    tracks_[i].surface_motion +=
        0.5 * dt *
        tools_[i].surface_velocity(tools_[i].place(), tissue_, tissue_.velocities, tissue_.loads_of(i));
  bool pressed = false;
  for (std::size_t i = 0; moves && i < tools_.size(); ++i) {
    tools_[i].carry(tracks_[i].surface_motion);
    tissue_.carry(i, tracks_[i].surface_motion);
    if (!tools_[i].placed()) continue;
    tissue_.apply_loads(i);
    pressed = true;
  }
  if (moves && !pressed) tissue_.press_by_none();
}

ToolForce Simulation::step(const ToolPose& pose, double dt) noexcept {
  inputs_.front().pose = pose;
  return step(inputs_, dt).front();
}

std::vector<MemoryPart> Simulation::memory() const {
  std::vector<MemoryPart> parts = tissue_.model->memory();
  parts.push_back({"mesh", organ_.mesh->vertices.size() * sizeof(Vec3) +
                               organ_.mesh->tetrahedra.size() * sizeof(Tetrahedron) +
                               organ_.mesh->mid_edges.size() * sizeof(organ_.mesh->mid_edges[0]) +
                               organ_.mesh->stiffness.size() * sizeof(double)});
  parts.push_back({"surface", organ_.surface.vertices.size() * sizeof(int) +
                                  organ_.surface.triangles.size() * sizeof(Triangle)});
  if (cut_) parts.push_back({"resection", cut_->bytes()});
  const std::size_t coupling_bytes = coupling_ ? coupling_->bytes() / tools_.size() : 0;  // of each
  for (std::size_t i = 0; i < tools_.size(); ++i)
    parts.push_back(
        {contact_part(i, tools_.size()), tools_[i].bytes() + tissue_.bytes_of(i) + coupling_bytes});
  return parts;
}

std::uint64_t Simulation::state_hash() const noexcept {
  Fnv1a hash;
  hash.add(tissue_.positions.data(), tissue_.positions.size_bytes());
  for (const ToolForce& answer : answers_) hash.add(answer.force);
  if (cut_) hash.add(organ_.surface.triangles.data(), organ_.surface.triangles.size() * sizeof(Triangle));
  return hash.value();
}

}  // namespace palpate::sim
