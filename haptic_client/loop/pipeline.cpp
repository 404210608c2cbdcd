#include "haptic_client/loop/pipeline.h"

#include <algorithm>

namespace palpate::client {
namespace {
constexpr double kVelocityFilter = 0.005;  // s, time constant of the velocity estimate
constexpr double kFadeDamping = 2;         // N s/m, in the device frame, while the force fades
}  // namespace

TickResult Pipeline::tick(const DeviceReading& reading, const protocol::ForceSample* arrived) noexcept {
  const double dt = tick_++ == 0 ? 0 : to_seconds(reading.t - last_t_);
  last_t_ = reading.t;
  if (!reading.valid || !reading.p_D.allFinite()) limiter_.latch(Fault::kDeviceLost);
  follow_motion(reading, dt);
  if (arrived != nullptr) take(*arrived);

  std::optional<Time> age;
  if (newest_.number > 0) {
    age = reading.t - newest_.t;
    stats_.age_ns.add(age->count());
  }
  const Watchdog::Ruling ruling = watchdog_.rule(age, period_, dt);
  Vec3 f_W = law_->force(p_W_, ruling.may_extrapolate_in_time ? reading.t : newest_.t);
  // A tool that the newest sample saw free feels nothing: a law that looks back would go on pulling (sticky
  // tissue).
  if (newest_.f.isZero(0)) f_W.setZero();
  const Vec3 v_D = v_W_ / workspace_.scale;
  const Vec3 damping_D = ruling.damper ? Vec3(-ruling.gain * kFadeDamping * v_D) : Vec3(Vec3::Zero());
  TickResult result;
  result.f_D = limiter_.limit(workspace_.to_device(f_W), damping_D, dt, ruling.gain);
  stats_.max_newton = std::max(stats_.max_newton, result.f_D.norm());
  result.tool = {.tick = tick_,
                 .newest_sample = newest_.number,
                 .t_ns = reading.t.count(),
                 .p_W = p_W_,
                 .v_W = v_W_,
                 .buttons = reading.buttons};
  return result;
}

/// Position and filtered velocity in the world; both stay as they were while the device gives nothing usable.
void Pipeline::follow_motion(const DeviceReading& reading, double dt) noexcept {
  if (!reading.valid || !reading.p_D.allFinite()) return;
  const Vec3 p_W = workspace_.to_world(reading.p_D);
  if (dt > 0) {
    const Vec3 moved = p_W - p_W_;
    v_W_ += dt / (dt + kVelocityFilter) * (moved / dt - v_W_);
    stats_.path_m += moved.norm();
    stats_.path_s += dt;
    stats_.max_speed = std::max(stats_.max_speed, v_W_.norm());
  }
  p_W_ = p_W;
}

/// Uses a sample if it is newer than the newest: duplicates and latecomers would make time run backwards in
/// the laws.
void Pipeline::take(const protocol::ForceSample& arrived) noexcept {
  const Sample sample{arrived.number, Time{arrived.tool_t_ns}, arrived.p_W, arrived.f_W};
  const bool first = newest_.number == 0;
  if ((!first && sample.t <= newest_.t) || sample.t > last_t_) {
    ++stats_.overtaken;
    return;
  }
  if (!first && sample.t - newest_.t > Watchdog::kStale) {
    law_->restart();  // an outage, or another tool in another hand: no line leads from there to here
    period_ = Time::zero();
  } else if (!first) {
    period_ = sample.t - newest_.t;
    stats_.sample_path_m += (sample.p - newest_.p).norm();
    ++stats_.sample_pairs;
  }
  newest_ = sample;
  ++stats_.samples;
  law_->update(sample);
}

}  // namespace palpate::client
