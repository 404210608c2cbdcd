#include "haptic_client/loop/pipeline.h"

#include <algorithm>

namespace palpate::client {
using protocol::ForceSample;
using protocol::ToolState;

namespace {

constexpr double kVelocityFilter = 0.005;  // s, time constant of the velocity estimate
constexpr double kFadeDamping = 2;         // N s/m, in the device frame, while the force fades

double seconds_between(const ToolState& before, Time t) {
  return before.tick == 0 ? 0 : to_seconds(t - Time{before.t_ns});
}

}  // namespace

ToolState Pipeline::sense(const DeviceReading& reading) noexcept {
  const double dt = seconds_between(sensed_, reading.t);
  const bool was_lost = sensed_.tick == 0 || (sensed_.flags & ToolState::kDeviceLost) != 0;
  ++sensed_.tick;
  sensed_.t_ns = reading.t.count();
  sensed_.buttons = reading.buttons;
  sensed_.flags = rearm_asked_ ? ToolState::kRearmed : 0;
  rearm_asked_ = false;
  if (!reading.valid || !reading.p_D.allFinite()) {
    sensed_.flags |= ToolState::kDeviceLost;
    return sensed_;
  }
  const Vec3 p_W = workspace_.to_world(reading.p_D);
  if (was_lost) {
    sensed_.v_W.setZero();  // it may have gone anywhere meanwhile
  } else if (dt > 0) {
    sensed_.v_W += dt / (dt + kVelocityFilter) * ((p_W - sensed_.p_W) / dt - sensed_.v_W);
  }
  sensed_.p_W = p_W;
  return sensed_;
}

TickResult Pipeline::feel(const ToolState& tool, const ForceSample* arrived) noexcept {
  const Time now{tool.t_ns};
  const double dt = seconds_between(felt_, now);
  if ((tool.flags & ToolState::kRearmed) != 0) {
    limiter_.rearm();
    watchdog_.restart();
  }
  const bool lost = (tool.flags & ToolState::kDeviceLost) != 0;
  follow_path(tool, dt);
  TickResult result{.tool = tool};
  if (arrived != nullptr && take(*arrived, now)) {
    result.used = true;
    result.sample = estimate_.newest();
    result.step = Time{arrived->step_ns};
  }
  result.tool.newest_sample = estimate_.newest().number;
  felt_ = tool;

  std::optional<Time> age;
  if (estimate_.newest().number > 0) {
    age = now - estimate_.newest().t;
    stats_.age_ns.add(age->count());
  }
  const Watchdog::Ruling ruling = watchdog_.rule(age, dt);
  if (lost) watchdog_.restart();  // so that it comes back softly
  const Vec3 f_W = estimate_.force(tool.p_W, now);
  const Vec3 v_D = tool.v_W / workspace_.scale;
  const Vec3 damping_D = ruling.damper ? Vec3(-ruling.gain * kFadeDamping * v_D) : Vec3(Vec3::Zero());
  result.f_D = lost ? limiter_.drop() : limiter_.limit(workspace_.to_device(f_W), damping_D, dt, ruling.gain);
  stats_.max_newton = std::max(stats_.max_newton, result.f_D.norm());
  return result;
}

std::int64_t Pipeline::age_ns() const noexcept {
  return estimate_.newest().number == 0 ? -1 : felt_.t_ns - estimate_.newest().t.count();
}

void Pipeline::follow_path(const ToolState& tool, double dt) noexcept {
  const bool known = ((tool.flags | felt_.flags) & ToolState::kDeviceLost) == 0;
  if (dt <= 0 || !known) return;
  stats_.path_m += (tool.p_W - felt_.p_W).norm();
  stats_.path_s += dt;
  stats_.max_speed = std::max(stats_.max_speed, tool.v_W.norm());
}

bool Pipeline::take(const ForceSample& arrived, Time now) noexcept {
  const Vec3 before = estimate_.newest().p;
  if (!estimate_.take({arrived.number, Time{arrived.tool_t_ns}, arrived.p_W, arrived.f_W}, now)) {
    ++stats_.overtaken;
    return false;
  }
  ++stats_.samples;
  if (estimate_.period() > Time::zero()) {
    stats_.sample_path_m += (arrived.p_W - before).norm();
    stats_.sample_path_s += to_seconds(estimate_.period());
    ++stats_.sample_pairs;
  }
  return true;
}

}  // namespace palpate::client
