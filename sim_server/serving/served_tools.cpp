#include "sim_server/serving/served_tools.h"

#include <algorithm>
#include <cassert>
#include <new>

#include "common/time.h"

namespace palpate::sim {
using protocol::ForceSample;

namespace {

constexpr double kLongestBend = 0.1;  // s between two states; after more, velocities tell nothing of the path

protocol::ModalState on_the_wire(const ModalMotion& modes) noexcept {
  protocol::ModalState published{.count = static_cast<std::uint8_t>(modes.q.size())};
  for (Eigen::Index k = 0; k < modes.q.size(); ++k) {
    published.q[static_cast<std::size_t>(k)] = static_cast<float>(modes.q[k]);
    published.v[static_cast<std::size_t>(k)] = static_cast<float>(modes.v[k]);
  }
  return published;
}

protocol::ModalLoads on_the_wire(const Eigen::VectorXd& loads) noexcept {
  const auto modes = static_cast<std::size_t>(loads.size());
  protocol::ModalLoads published{.count = static_cast<std::uint8_t>(protocol::ModalLoads::room(modes))};
  for (std::size_t k = 0; k < published.count; ++k)
    published.load[k] = static_cast<float>(loads[static_cast<Eigen::Index>(k)]);
  return published;
}

/// Publishes the force around the tool, now and ahead, and how the other tools move it.
void publish_nearby(const ToolAnswer& answer, ForceSample& sample) noexcept {
  if (answer.at_tool) {
    sample.flags |= ForceSample::kHasTangent;
    sample.surface_v_W = answer.surface_v_W;
    sample.at_tool = *answer.at_tool;
  }
  if (answer.ahead) {
    sample.flags |= ForceSample::kHasAhead;
    sample.ahead_p_W = answer.ahead->p_W;
    sample.ahead_f_W = answer.ahead->f_W;
    sample.ahead = *answer.ahead;
  }
  if (answer.others) {
    sample.flags |= ForceSample::kHasOthers;
    sample.others = *answer.others;
  }
}

/// Publishes where the `surface` that the client knows is, and how it swings.
void publish_surface(const ToolAnswer& answer, const protocol::SurfaceState& surface,
                     ForceSample& sample) noexcept {
  if (!answer.surface_shift_W) return;
  sample.flags |= ForceSample::kHasSurface;
  sample.surface = surface;
  sample.surface.shift_W = *answer.surface_shift_W;
  if (answer.modes == nullptr) return;
  sample.flags |= ForceSample::kHasModes;
  sample.modes = on_the_wire(*answer.modes);
  if (answer.modal_loads == nullptr) return;
  sample.flags |= ForceSample::kHasModalLoads;
  sample.modal_loads = on_the_wire(*answer.modal_loads);
}

ToolPath::Point point_of(const protocol::ToolState& state) noexcept {
  return {state.t_ns, pose_of(state), state.v_W};
}

/// Returns how a tool went from one point to the next, by its velocities and its own clock.
Bend bend_between(const ToolPath::Point& before, const ToolPath::Point& now) noexcept {
  const double dt = 1e-9 * (static_cast<double>(now.t_ns) - static_cast<double>(before.t_ns));
  if (!(dt > 0 && dt < kLongestBend)) return {};
  const Vec3 chord = now.pose.p_W - before.pose.p_W;
  return {dt * before.v_W - chord, dt * now.v_W - chord};
}

}  // namespace

PublishedForce published_force(const ForceSample& sample) noexcept {
  PublishedForce force{.number = sample.number,
                       .t = Time{sample.tool_t_ns},
                       .p = sample.p_W,
                       .f = sample.f_W,
                       .surface_v = sample.surface_v_W + sample.others.v_W,
                       .cuts = sample.cuts};
  if ((sample.flags & ForceSample::kHasTangent) != 0) force.tangent = sample.at_tool.tangent;
  return force;
}

void SessionInput::follow(const protocol::ToolState& newest) noexcept {
  const auto before = path.newest();
  const double gap =
      before ? static_cast<double>(newest.t_ns) - static_cast<double>(before->t_ns) : 0;  // any, off the wire
  if (gap > static_cast<double>(kGap.count()) || was_lost) {
    ++beginnings;
    path = {};
  }
  was_lost = (newest.flags & protocol::ToolState::kDeviceLost) != 0;
  if (was_lost) path = {};  // its pose is of long ago
  path.add(newest);
}

ServedTools::ServedTools(Simulation& simulation, const ErrorOfForce* errors)
    : simulation_(simulation),
      errors_(errors),
      pagers_(simulation.tools()),
      surfaces_(simulation.tools()),
      holders_(simulation.tools()),
      paths_(simulation.tools(), std::vector<PathPoint>(static_cast<std::size_t>(simulation.instants() - 1))),
      inputs_(simulation.tools()),
      outcomes_(simulation.tools()) {
  make_pagers();
  if (simulation.published_modes() != nullptr && !simulation.published_modes()->relaxations.empty())
    relaxation_.emplace(*simulation.published_modes(), pagers_.back()->vertices());
}

/// One that there is no memory for tells nothing.
void ServedTools::make_pagers() {
  for (std::size_t i = 0; i < simulation_.tools(); ++i) {
    surfaces_[i] = {};
    pagers_[i] = std::make_shared<SurfacePager>(simulation_, i);
    surfaces_[i] = pagers_[i]->state();
  }
}

/// Follows the simulation, where it publishes another surface from this step on, or none. Without memory for
/// it, none.
void ServedTools::follow_surface() noexcept {
  if (simulation_.published_version() == published_version_) return;
  published_version_ = simulation_.published_version();
  try {
    make_pagers();
  } catch (const std::bad_alloc&) {
    std::ranges::fill(surfaces_, protocol::SurfaceState{});
  }
}

std::span<const ServedTools::Outcome> ServedTools::step(std::span<const SessionInput> inputs,
                                                        double dt) noexcept {
  assert(inputs.size() == holders_.size());
  bool handed_over = false;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const bool handed = hand_over(i, inputs[i].session), begins = enters(i, inputs[i]);
    inputs_[i] = input_of(i, inputs[i]);
    inputs_[i].enters = handed || begins;
    handed_over = handed_over || handed;
    holders_[i].before = inputs[i].state;
  }
  const bool held = std::ranges::any_of(holders_, [](const Holder& h) { return h.session != 0; });
  if (!held && !handed_over) return {};
  const std::span<const ToolAnswer> answers =
      simulation_.step(inputs_, held ? dt : 0);  // or free of the last
  if (!held) return {};
  follow_surface();
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    outcomes_[i] = {answers[i], {}};
    if (inputs[i].session != 0 && inputs[i].fresh) {
      outcomes_[i].answer = holders_[i].last = sample_of(i, inputs[i].state, answers[i]);
      holders_[i].flagged += answers[i].flagged ? 1 : 0;
    }
    outcomes_[i].flagged_samples = holders_[i].flagged;
  }
  return outcomes_;
}

/// Returns true if the tool is in another hand, or nobody's: it does not travel from one to the other.
bool ServedTools::hand_over(std::size_t tool, std::uint64_t session) noexcept {
  if (session == holders_[tool].session) return false;
  holders_[tool] = {};
  holders_[tool].session = session;
  return true;
}

/// Returns true if the path of the tool has begun anew since the last step.
bool ServedTools::enters(std::size_t tool, const SessionInput& input) noexcept {
  Holder& holder = holders_[tool];
  if (holder.beginnings == input.beginnings) return false;
  holder.beginnings = input.beginnings;
  holder.before = {};
  return true;
}

std::optional<ForceSample> ServedTools::paused(std::size_t tool, const SessionInput& input) noexcept {
  hand_over(tool, input.session);
  if (input.session == 0) return {};
  ForceSample& last = holders_[tool].last;
  if (last.number == 0) {
    last.tool = static_cast<std::uint8_t>(tool);
    last.tool_tick = input.state.tick;
    last.tool_t_ns = input.state.t_ns;
    last.p_W = input.state.p_W;
  }
  last.number = ++holders_[tool].samples;
  last.flags |= ForceSample::kPaused;
  return last;
}

/// The state of a tool for the simulation, with the requests: an old state deserves no new answer.
ToolInput ServedTools::input_of(std::size_t tool, const SessionInput& input) noexcept {
  const protocol::ToolState& state = input.state;
  const auto says = [&](std::uint16_t flag) { return (state.flags & flag) != 0; };
  const auto request = [&](std::uint16_t flag) { return input.session != 0 && input.fresh && says(flag); };
  ToolInput published{.buttons = state.buttons, .v_W = state.v_W};
  follow_path(tool, input, published);
  // The pose of a lost device is the last one known, or none: it touches nothing.
  if (input.session != 0 && !says(protocol::ToolState::kDeviceLost)) published.pose = pose_of(state);
  published.request.at_tool = request(protocol::ToolState::kRequestsTangent);
  published.request.tangent = input.fresh && says(protocol::ToolState::kRequestsTangent);
  if (request(protocol::ToolState::kRequestsAhead))
    published.request.ahead = ToolRequest::Ahead{to_seconds(Time{state.lead_ns}), state.v_W};
  // Of one that can be cut only where it is asked for, and of the shape of tool that clients know.
  const bool published_later =
      simulation_.resection() != nullptr && simulation_.tool(tool).shape().is_sphere();
  published.request.surface_shift =
      request(protocol::ToolState::kRequestsSurface) && (published_later || surfaces_[tool].version != 0);
  return published;
}

/// Adds where the tool was at the instants since the state that the step before answered.
void ServedTools::follow_path(std::size_t tool, const SessionInput& input, ToolInput& published) noexcept {
  std::vector<PathPoint>& points = paths_[tool];
  const bool was_lost = (holders_[tool].before.flags & protocol::ToolState::kDeviceLost) != 0;
  ToolPath::Point from = point_of(holders_[tool].before);
  const ToolPath::Point to = point_of(input.state);
  const auto instants = static_cast<std::int64_t>(points.size()) + 1;
  const double distance =
      static_cast<double>(to.t_ns) - static_cast<double>(from.t_ns);  // ns; any, off the wire
  const std::int64_t begin = from.t_ns, took = distance > 0 && distance < 1e9 ? to.t_ns - begin : 0;
  for (std::int64_t k = 1; k < instants; ++k) {
    const auto now = took > 0 ? input.path.at(begin + took * k / instants) : std::nullopt;
    if (!now || was_lost) return;  // evenly and straight, or it appears
    points[static_cast<std::size_t>(k) - 1] = {now->pose, bend_between(from, *now)};
    from = *now;
  }
  published.path = points;
  published.bend = bend_between(from, to);
}

ForceSample ServedTools::sample_of(std::size_t tool, const protocol::ToolState& state,
                                   const ToolAnswer& answer) noexcept {
  ForceSample sample{.tool = static_cast<std::uint8_t>(tool),
                     .number = ++holders_[tool].samples,
                     .tool_tick = state.tick,
                     .tool_t_ns = state.t_ns,
                     .p_W = state.p_W,
                     .f_W = answer.force,
                     .torque_W = answer.torque};
  if (answer.contacts > 0) sample.flags |= ForceSample::kInContact;
  if (answer.flagged)
    sample.flags |= ForceSample::kFlagged | ForceSample::kFailed << static_cast<unsigned>(answer.doubt);
  if (answer.strained) sample.flags |= ForceSample::kStrained;
  publish_nearby(answer, sample);
  if (surfaces_[tool].version != 0) publish_surface(answer, surfaces_[tool], sample);
  if (simulation_.instants() > 1 && answer.at_tool) {
    sample.flags |= ForceSample::kHasMean;
    sample.mean_f_W = answer.mean_force;
  }
  if (const Resection* const resection = simulation_.resection()) {
    sample.flags |= ForceSample::kHasCuts;
    sample.cuts = resection->version();
    if (answer.cutting) sample.flags |= ForceSample::kCutting;
  }
  if (errors_ != nullptr && (state.flags & protocol::ToolState::kRequestsErrors) != 0) {
    sample.flags |= ForceSample::kHasErrors;
    sample.errors = errors_->of_step(tool, simulation_.loads(tool));
  }
  if (relaxation_ && (sample.flags & ForceSample::kHasModes) != 0) relaxation_->report(*answer.modes, sample);
  return sample;
}

}  // namespace palpate::sim
