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
std::size_t make_room_for_loads(const ToolGroup& tools, Tissue& tissue) {
  std::vector<int> most_loads;
  std::vector<double> radii;
  for (const ToolContact& tool : tools.all()) {
    most_loads.push_back(tool.max_nodes());
    radii.push_back(tool.radius());
  }
  tissue.reserve(most_loads, radii);
  if (tools.have_friction()) tissue.before.assign(tissue.positions.begin(), tissue.positions.end());
  return static_cast<std::size_t>(std::accumulate(most_loads.begin(), most_loads.end(), 0));
}

/// Holds the last force: what a tool presses with on tissue that found no balance may be anything.
void hold(ToolAnswer& answer) noexcept {
  answer.tangent.setZero();
  answer.mean_force = answer.force;
  answer.flagged = true;
}

/// Halves the last force each step once the solution is lost.
void fade(ToolAnswer& answer) noexcept {
  answer.force *= 0.5;
  answer.torque *= 0.5;
  hold(answer);
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
  if (row.deforms() && scene.material) state_.strain.emplace(scene.material->law);
  const std::vector<int> held = on_surface(fixed, organ_.surface);
  tools_ = ToolGroup(make_tools(scene, tissue_.free, organ_.surface, std::move(touchable), held, progress),
                     organ_.rest.size());
  publisher_ = StepPublisher(tools_.size(), organ_.rest.size(), make_room_for_loads(tools_, tissue_));
  publisher_.reserve(published_modes(), organ_.rest.size());
  state_.paths.resize(tools_.size());
  state_.means.resize(tools_.size());
  state_.answers.resize(tools_.size());
  inputs_.resize(tools_.size());
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

/// 1 for each surface vertex of a part that nothing holds; empty: there is none.
std::span<const char> Simulation::floating() const noexcept {
  return cut_ ? cut_->floating() : std::span<const char>();
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
    if (inputs[i].enters) release_tool(i);
  }
  try {
    advance(inputs, dt);
    state_.failed = false;
  } catch (const std::bad_alloc&) {
    ++state_.failures.out_of_memory;
    hold_answers(inputs);
  } catch (...) {
    ++state_.failures.other;
    hold_answers(inputs);
  }
  explain_flagged();
  return state_.answers;
}

/// Says why answers are flagged, and counts the step by the first reason.
void Simulation::explain_flagged() noexcept {
  const auto first = std::ranges::find_if(state_.answers, &ToolAnswer::flagged);
  if (first == state_.answers.end()) return;
  using Balance = NonlinearModel::Balance;
  const NonlinearModel* const nonlinear = tissue_.traits.nonlinear;
  const Balance balance = nonlinear ? nonlinear->balance() : Balance::kBalanced;
  const std::optional<Doubt> of_all = state_.failed                     ? std::optional(Doubt::kFailed)
                                      : state_.ran_away                 ? Doubt::kRanAway
                                      : balance == Balance::kInsideOut  ? Doubt::kInsideOut
                                      : balance == Balance::kUnbalanced ? Doubt::kNotBalanced
                                      : !tools_.settled()               ? std::optional(Doubt::kTools)
                                                                        : std::nullopt;
  for (ToolAnswer& answer : state_.answers) answer.doubt = of_all.value_or(answer.doubt);
  state_.flagged.count(first->doubt);
}

/// Holds the answers after a step that threw. The forces of a tissue that answers no more fade.
void Simulation::hold_answers(std::span<const ToolInput> inputs) noexcept {
  for (std::size_t i = 0; i < state_.answers.size(); ++i) {
    ToolAnswer held;
    if (inputs[i].pose) static_cast<ToolForce&>(held) = state_.answers[i];
    state_.failed ? fade(held) : hold(held);
    held.flagged = inputs[i].pose.has_value();
    state_.answers[i] = held;
  }
  state_.failed = true;
}

void Simulation::advance(std::span<const ToolInput> inputs, double dt) {
  std::ranges::fill(state_.means, Mean{});
  tissue_.start_step();
  if (cut_ && cut_->start_step(inputs, state_.time, dt, cut_organ())) {
    ++state_.published_version;
    publisher_.reserve(published_modes(), organ_.rest.size());
  }
  tools_.start_step(inputs);
  if (tissue_.traits.cuttable != nullptr && instants() > 1)
    tools_.restrict_contact(inputs, state_.paths, organ_.surface.triangles, tissue_);
  for (int instant = 1; instant <= instants(); ++instant)
    advance_to_instant(inputs, instant, dt / instants());
  for (std::size_t i = 0; i < tools_.size(); ++i) state_.paths[i].end_step(inputs[i].pose);
  state_.ran_away = ran_away();
  for (std::size_t i = 0; i < tools_.size(); ++i) answer(i, inputs[i], dt);
  if (cut_) cut_->end_step(inputs, state_.time, dt, tools_.all(), state_.answers);
  state_.time += dt;
  publisher_.couple(inputs, after_step());
  for (std::size_t i = 0; i < tools_.size(); ++i)
    publisher_.add_wanted(i, inputs[i], published_modes(), instants() == 1, after_step(), state_.answers[i]);
}

/// Sets the force on a tool.
void Simulation::answer(std::size_t tool, const ToolInput& input, double dt) {
  ToolContact& contact = tools_[tool];
  ToolAnswer& answer = state_.answers[tool];
  const ToolForce before = answer;
  answer = {};
  static_cast<ToolForce&>(answer) = before;
  if (state_.ran_away && contact.placed()) return fade(answer);
  if (instants() > 1)
    contact.predict_tangent(std::max(dt, input.request.ahead ? input.request.ahead->seconds : 0));
  const bool publishes_tangents = tissue_.traits.publishes_tangents;
  if (contact.force().flagged && !balanced()) return hold(answer);
  if (input.request.tangent && publishes_tangents) tools_.differentiate(tool, tissue_);
  static_cast<ToolForce&>(answer) = contact.force();
  if (!publishes_tangents) answer.force = state_.means[tool].late;
  answer.mean_force = state_.means[tool].all;
  if (cut_) cut_->resist(tool, contact, dt, answer);
  judge_place(contact, answer);
  if (!answer.flagged || answer.doubt != Doubt::kInsideOut) return;
  static_cast<ToolForce&>(answer) = before;
  hold(answer);
}

/// Whether a force that was found means what it seems to: the tool may be where nothing is touchable, or the
/// tissue under it strained beyond its law, or turned inside out.
void Simulation::judge_place(const ToolContact& tool, ToolAnswer& answer) noexcept {
  if (answer.flagged) return;
  if (state_.strain && answer.contacts > 0) {
    const double strain = tool.surface_strain(tissue_.positions, organ_.rest);
    answer.strained = state_.strain->add(strain);
    const double area = tool.least_area(tissue_.positions, organ_.rest, floating());
    if (state_.strain->is_inside_out(strain, area)) {
      answer.flagged = true;
      answer.doubt = Doubt::kInsideOut;
      return;
    }
  }
  const double depth = tool.depth_outside_reach(tissue_.positions);
  if (depth == 0) return;
  answer.flagged = true;
  answer.doubt = Doubt::kOutsideReach;
  state_.flagged.deepest = std::max(state_.flagged.deepest, depth);
}

/// Takes a tool away: the tissue becomes free of it.
void Simulation::release_tool(std::size_t tool) noexcept {
  state_.answers[tool] = {};
  state_.paths[tool].clear();
  tools_.release(tool, tissue_);
}

/// The tissue goes on by `dt` (s), then contact is solved with the tools where they are by then; or, where
/// the model's force leads, where they will be at the next instant.
void Simulation::advance_to_instant(std::span<const ToolInput> inputs, int instant, double dt) {
  move_organ(dt);
  std::array<std::optional<PathPoint>, kMaxTools> to;
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    InstantPath& path = state_.paths[i];
    if (!inputs[i].pose) {
      release_tool(i);
    } else if (tissue_.traits.leading_force) {
      to[i] = path.ahead_of_instant(inputs[i], instant, instants(), tools_[i].shape());
    } else {
      to[i] = path.at_instant(inputs[i], instant, instants());
    }
  }
  tools_.advance(std::span(to).first(tools_.size()), tissue_);
  if (!tissue_.before.empty()) std::ranges::copy(tissue_.positions, tissue_.before.begin());
  const int late = (instants() + kLateParts - 1) / kLateParts;
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    state_.means[i].all += tools_[i].force().force / instants();
    if (instant > instants() - late) state_.means[i].late += tools_[i].force().force / late;
  }
}

/// True if some of the surface is at no finite place, or beyond any that an organ that is held can get to.
bool Simulation::ran_away() const noexcept {
  const std::span<const char> floats = floating();
  const auto is_near = [&](std::size_t v) {  // false of what is not a number, too
    const double most = !floats.empty() && floats[v] != 0 ? kAnywhere : organ_.furthest;
    return (tissue_.positions[v] - organ_.rest[v]).squaredNorm() <= most * most;
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
  std::array<Vec3, kMaxTools> motions;
  motions.fill(Vec3::Zero());
  const auto add_half = [&] {
    for (std::size_t i = 0; moves && i < tools_.size(); ++i)
      motions[i] +=
          0.5 * dt *
          tools_[i].surface_velocity(tools_[i].place(), tissue_, tissue_.velocities, tissue_.loads_of(i));
  };
  add_half();
  carry_before(tissue_, 0.5 * dt);
  tissue_.set_free(tissue_.model->free_motion(dt));
  carry_before(tissue_, 0.5 * dt);
  add_half();
  if (moves) tools_.carry(std::span(motions).first(tools_.size()), tissue_);
}

ToolForce Simulation::step(const ToolPose& pose, double dt) noexcept {
  inputs_.front().pose = pose;
  return step(inputs_, dt).front();
}

Linearisation Simulation::linearise(std::size_t tool, const Vec3& p_W, const ToolForce* known) {
  return StepPublisher::linearise(tool, p_W, known, after_step());
}

std::optional<double> Simulation::gap(std::size_t tool) const noexcept {
  if (!tools_[tool].placed() || tools_[tool].touchable().empty()) return {};
  return tools_[tool].nearest(tools_[tool].place(), tissue_).gap;
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
  const std::size_t shared_bytes = publisher_.bytes() / tools_.size();  // of each
  for (std::size_t i = 0; i < tools_.size(); ++i)
    parts.push_back({contact_part(i, tools_.size()), tools_[i].bytes() + tissue_.bytes_of(i) + shared_bytes});
  return parts;
}

std::uint64_t Simulation::state_hash() const noexcept {
  Fnv1a hash;
  hash.add(tissue_.positions.data(), tissue_.positions.size_bytes());
  for (const ToolForce& answer : state_.answers) hash.add(answer.force);
  if (cut_) hash.add(organ_.surface.triangles.data(), organ_.surface.triangles.size() * sizeof(Triangle));
  return hash.value();
}

}  // namespace palpate::sim
