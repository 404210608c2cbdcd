#include "haptic_client/pipeline/pipeline.h"

#include <algorithm>

#include "haptic_client/extrapolation/organ_motion.h"

namespace palpate::client {
using protocol::ForceSample;
using protocol::ToolState;

namespace {

constexpr double kVelocityFilter = 0.005;                      // s, time constant of the velocity estimate
constexpr int kLeadFilter = 8;                                 // samples
constexpr Time kRequestPeriod = std::chrono::milliseconds(8);  // a thousand pages a second at most
constexpr double kDamperFraction = 0.25;                       // of the largest force: all dampers together
constexpr double kFadeDamping = 2;         // N s/m, in the device frame, while the force fades
constexpr double kFadeDampingRise = 0.03;  // s, from none to all of it and back: no step of a fast hand

/// A message has place and force beside the linearisation.
Linearisation placed(Linearisation l, const Vec3& p_W, const Vec3& f_W) noexcept {
  l.p_W = p_W;
  l.f_W = f_W;
  return l;
}

double seconds_between(const ToolState& before, Time t) {
  return before.tick == 0 ? 0 : to_seconds(t - Time{before.t_ns});
}

}  // namespace

Sample sample_of(const ForceSample& s, SurfaceModel* model) noexcept {
  Sample sample{s.number, Time{s.tool_t_ns}, s.p_W, s.f_W, s.surface_v_W};
  if ((s.flags & ForceSample::kHasCuts) != 0) sample.cuts = s.cuts;
  sample.cutting = (s.flags & ForceSample::kCutting) != 0;
  sample.settled = (s.flags & ForceSample::kFlagged) == 0;
  if ((s.flags & ForceSample::kHasTangent) != 0) sample.at_tool = placed(s.at_tool, s.p_W, s.f_W);
  if ((s.flags & ForceSample::kHasAhead) != 0) sample.ahead = placed(s.ahead, s.ahead_p_W, s.ahead_f_W);
  if ((s.flags & ForceSample::kHasOthers) != 0) {
    sample.others = s.others;
    sample.surface_v += s.others.v_W;
  }
  if ((s.flags & ForceSample::kHasSurface) != 0 && model != nullptr) {
    const bool swings = (s.flags & ForceSample::kHasModes) != 0;
    model->announce(s.surface, swings ? s.modes.count : 0);
    sample.surface = Surface{model,
                             s.surface.shift_W,
                             {s.surface.tool_radius, s.surface.tool_friction},
                             s.surface.tool_compliance};
    if (swings) sample.surface->modes = {s.modes.count, s.modes.q, s.modes.v};
    if (swings && (s.flags & ForceSample::kHasRelaxed) != 0) sample.surface->relaxed = s.relaxed;
    if (swings && (s.flags & ForceSample::kHasModalLoads) != 0) sample.surface->modal_loads = s.modal_loads;
  }
  return sample;
}

void Pipeline::set_request(const Request& request) {
  request_ |= request;
  if (request_.surface && !model_) model_ = std::make_unique<SurfaceModel>();
}

ToolState Pipeline::sense(const DeviceReading& reading) noexcept {
  const double dt = seconds_between(sensed_, reading.t);
  const bool was_lost = sensed_.tick == 0 || (sensed_.flags & ToolState::kDeviceLost) != 0;
  ++sensed_.tick;
  sensed_.t_ns = reading.t.count();
  sensed_.buttons = reading.buttons;
  sensed_.flags = rearm_requested_ ? ToolState::kRearmed : 0;
  rearm_requested_ = false;
  if (request_.at_tool) sensed_.flags |= ToolState::kRequestsTangent;
  if (request_.ahead) sensed_.flags |= ToolState::kRequestsAhead;
  if (request_.surface) sensed_.flags |= ToolState::kRequestsSurface;
  if (request_.errors) sensed_.flags |= ToolState::kRequestsErrors;
  sensed_.lead_ns = request_.ahead ? lead_.count() : 0;
  const bool release = paused_ && watchdog_.gain() == 0;
  if (release || (reading.buttons & workspace_.clutch) != 0) sensed_.flags |= ToolState::kClutched;
  if (!reading.valid || !reading.p_D.allFinite()) {
    sensed_.flags |= ToolState::kDeviceLost;
    return sensed_;
  }
  if ((sensed_.flags & ToolState::kClutched) != 0 && placed_)  // the world moves with the hand
    workspace_.offset_W += sensed_.p_W - workspace_.to_world(reading.p_D);
  placed_ = true;
  const Vec3 p_W = workspace_.to_world(reading.p_D);
  if (was_lost) {
    sensed_.v_W.setZero();  // it may have gone anywhere meanwhile
  } else if (dt > 0) {
    sensed_.v_W += dt / (dt + kVelocityFilter) * ((p_W - sensed_.p_W) / dt - sensed_.v_W);
  }
  sensed_.p_W = p_W;
  if (reading.q_D) {
    const Quat turned = Quat(workspace_.axes) * *reading.q_D;
    sensed_.q_W = {turned.w(), turned.x(), turned.y(), turned.z()};
  }
  return sensed_;
}

TickResult Pipeline::render(const ToolState& tool, const ForceSample* arrived,
                            std::span<const protocol::SurfacePage> pages) noexcept {
  const Time now{tool.t_ns};
  const double dt = seconds_between(rendered_, now);
  if ((tool.flags & ToolState::kRearmed) != 0 && limiter_.fault() != Fault::kNone) {
    limiter_.rearm();
    watchdog_.restart();
  }
  follow_path(tool, dt);
  TickResult result{.tool = tool};
  if (model_) {
    for (const protocol::SurfacePage& page : pages) {
      const auto waited = model_->waited_for(page.page, now);
      if (waited && page.version == model_->version()) pace_.came(*waited);
      model_->take(page);
    }
  }
  stats_.pages += pages.size();
  if (arrived != nullptr) {
    paused_ = (arrived->flags & ForceSample::kPaused) != 0;
    heard_ns_ = tool.t_ns;
  } else if ((tool.flags & ToolState::kInPause) != 0) {
    paused_ = true;  // of a capture: what said so was not taken
  }
  if (arrived != nullptr && !paused_ && take(*arrived, tool.p_W, now)) {
    result.used = true;
    result.flagged = (arrived->flags & ForceSample::kFlagged) != 0;
    result.sample = estimate_.newest();
    result.step = Time{arrived->step_ns};
    if ((arrived->flags & ForceSample::kHasErrors) != 0) result.errors = arrived->errors;
  }
  result.tool.newest_sample = estimate_.newest().number;
  if (paused_) result.tool.flags |= ToolState::kInPause;
  if (model_) request_pages(result.tool, now);
  if (rendered_.tick > 0) {
    const Vec3& surface_v = estimate_.newest().surface_v;
    const bool organ = surface_v.norm() <= OrganMotion::kFastest;
    passivity_.moved(now, workspace_.motion_to_device(tool.p_W - rendered_.p_W),
                     workspace_.motion_to_device(organ ? surface_v : Vec3(Vec3::Zero())), dt);
  }
  result.law_W = estimate_.force(tool.p_W, now);
  result.f_D = safe(result.law_W, tool, dt);
  result.gain = watchdog_.gain();
  if (result.tool.newest_sample > 0) {
    if (stats_.published == 0) stats_.first_published = now;
    if (!estimate_.stepped_down() && stats_.first_itself == Time{}) stats_.first_itself = now;
    ++stats_.published;
    stats_.stepped_down += estimate_.stepped_down() ? 1 : 0;
    stats_.substitutes.add(estimate_.substitute());
  }
  rendered_ = tool;
  return result;
}

void Pipeline::request_pages(ToolState& tool, Time now) noexcept {
  tool.pages_taken = stats_.pages;
  tool.flags &= static_cast<std::uint16_t>(~ToolState::kAsksPages);
  const auto& surface = estimate_.newest().surface;
  if (!surface || model_->version() == 0 || now - requested_ < kRequestPeriod) return;
  requested_ = now;
  const Vec3 p_rest = tool.p_W - surface->shift;
  const double reach = protocol::NearTiles::reach(surface->tool.radius, tool.v_W.norm());
  const std::span<std::uint32_t> room(tool.pages);
  std::ranges::fill(room, ToolState::kNoPage);
  const auto chosen = room.first(std::min(pace_.allowed(now), room.size()));
  const std::uint64_t again = model_->requested_again();
  if (chosen.empty() || !model_->choose_missing(p_rest, reach, now, chosen, pace_.patience())) return;
  pace_.lost(model_->requested_again() - again);
  pace_.requested(static_cast<std::size_t>(std::count_if(
      chosen.begin(), chosen.end(), [](std::uint32_t page) { return page != ToolState::kNoPage; })));
  tool.flags |= ToolState::kAsksPages;
  tool.surface_version = model_->version();
}

/// Returns what of the force `f_W` (N, world) may go to the motors: passivity, watchdog, limiter.
Vec3 Pipeline::safe(const Vec3& f_W, const ToolState& tool, double dt) noexcept {
  const bool lost = (tool.flags & ToolState::kDeviceLost) != 0,
             clutched = (tool.flags & ToolState::kClutched) != 0, off = lost || clutched;
  stats_.lost += lost ? 1 : 0;
  stats_.clutched += clutched ? 1 : 0;
  const Vec3 law_D = workspace_.to_device(f_W), rendered_D = limiter_.clamp(law_D, dt);
  const Passivity::Ruling passive = passivity_.rule(dt);
  const Watchdog::Ruling watchdog = rule_by_age(tool, dt);
  if (off) watchdog_.restart();  // so that it comes back softly
  const double fade = watchdog.damper && !off ? watchdog.gain * kFadeDamping : 0,
               step = kFadeDamping / kFadeDampingRise * std::clamp(dt, 0.0, kLongestTick);
  fade_damping_ += std::clamp(fade - fade_damping_, -step, step);
  const double damping = passive.damping + fade_damping_;
  const Vec3 damper_D = limiter_.within(kDamperFraction, -damping * workspace_.motion_to_device(tool.v_W));
  const Vec3 f_D =
      off ? limiter_.drop() : limiter_.push(watchdog.gain * passive.gain * rendered_D + damper_D, dt);
  passivity_.wrote(rendered_D, damper_D);
  law_newton_ = law_D.stableNorm();
  if (off || watchdog.gain < 1) {
    passivity_.restart();
    rendered_fraction_.restart();
  } else {
    rendered_fraction_.tick(law_D, f_D, dt);
  }
  stats_.max_newton = std::max(stats_.max_newton, f_D.norm());
  return f_D;
}

Watchdog::Ruling Pipeline::rule_by_age(const ToolState& tool, double dt) noexcept {
  if (estimate_.newest().number == 0) return watchdog_.rule({}, false, dt);
  const Time age = Time{tool.t_ns} - estimate_.newest().t;
  if (!paused_) stats_.age_ns.add(age.count());
  const Watchdog::Ruling ruling =
      watchdog_.rule(paused_ ? std::max(age, kOutage + Time{1}) : age, !estimate_.newest().settled, dt);
  stats_.unsettled += ruling.unsettled ? 1 : 0;
  return ruling;
}

std::optional<Doubt> Pipeline::doubt() const noexcept {
  if (!watchdog_.doubtful()) return {};
  for (const Doubt doubt : {Doubt::kFailed, Doubt::kRanAway, Doubt::kInsideOut, Doubt::kNotBalanced,
                            Doubt::kTools, Doubt::kOutsideReach}) {
    if ((doubts_ & ForceSample::kFailed << static_cast<unsigned>(doubt)) != 0) return doubt;
  }
  return Doubt::kContact;
}

std::int64_t Pipeline::age_ns() const noexcept {
  if (paused_) return rendered_.t_ns - heard_ns_;
  return estimate_.newest().number == 0 ? -1 : rendered_.t_ns - estimate_.newest().t.count();
}

void Pipeline::follow_path(const ToolState& tool, double dt) noexcept {
  const bool known = ((tool.flags | rendered_.flags) & ToolState::kDeviceLost) == 0;
  if (dt <= 0 || !known) return;
  stats_.path_m += (tool.p_W - rendered_.p_W).norm();
  stats_.path_s += dt;
  stats_.max_speed = std::max(stats_.max_speed, tool.v_W.norm());
}

bool Pipeline::take(const ForceSample& arrived, const Vec3& p_W, Time now) noexcept {
  if (limiter_.is_implausible(arrived.f_W)) {  // judged before it is booked: no law, and no account, sees it
    ++stats_.wild;
    return false;
  }
  const Vec3 before = estimate_.newest().p;
  const bool another = arrived.number <= estimate_.newest().number;
  if (!estimate_.take(sample_of(arrived, model_.get()), p_W, now)) {
    ++stats_.overtaken;
    return false;
  }
  if (another) watchdog_.restart();  // perhaps another organ: force from none again
  const Sample& newest = estimate_.newest();
  passivity_.sampled(newest.t, workspace_.motion_to_device(newest.p), workspace_.to_device(newest.f),
                     limiter_.max_force());
  pace_.heard(now - newest.t, Time{arrived.step_ns}, now);
  const Time lead = now - newest.t + estimate_.period() / 2;
  lead_ += (std::min(lead, kOutage) - lead_) / (stats_.samples == 0 ? 1 : kLeadFilter);
  ++stats_.samples;
  const bool flagged = (arrived.flags & ForceSample::kFlagged) != 0;
  stats_.flagged += flagged ? 1 : 0;
  stats_.strained += (arrived.flags & ForceSample::kStrained) != 0 ? 1 : 0;
  if (flagged) doubts_ = arrived.flags;
  if (estimate_.period() > Time::zero()) {
    stats_.sample_path_m += (arrived.p_W - before).norm();
    stats_.sample_path_s += to_seconds(estimate_.period());
    ++stats_.sample_pairs;
  }
  return true;
}

}  // namespace palpate::client
