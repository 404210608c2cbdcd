#include "haptic_client/extrapolation/modal_memory.h"

#include <algorithm>
#include <limits>

#include "common/ages.h"

namespace palpate::client {
namespace {
constexpr Time kStep = std::chrono::microseconds(500);      // what remains to a tick is by Taylor's series
constexpr double kMaxSwing = 0.2;                           // m: no organ swings so far
constexpr double kSamePlace = 1e-3;                         // m
constexpr Time kTrend = std::chrono::milliseconds(100);     // a trend is extrapolated no longer than this
constexpr double kOther = 0.8;                              // of the larger load: a larger change is no trend
constexpr Time kTrendBase = std::chrono::milliseconds(20);  // samples this far apart determine a trend
}  // namespace

ModalMemory::ModalMemory() = default;

void ModalMemory::restart() noexcept {
  known_ = standing_ = others_.driven = false;
  others_.now = others_.before = {};
  past_.forget();
}

bool ModalMemory::take_spectrum(const Surface& surface) noexcept {
  const auto spectrum = surface.model->spectrum();
  if (spectrum.size() != static_cast<std::size_t>(surface.modes.count)) return false;
  if (version_ == surface.model->generation()) return true;
  version_ = surface.model->generation();
  known_ = false;
  past_.forget();
  system_.count = spectrum.size();
  for (std::size_t k = 0; k < system_.count; ++k) {
    system_.w[k] = spectrum[k].frequency;
    system_.damping[k] = spectrum[k].damping;
  }
  short_step_.prepare(to_seconds(kStep), system_);
  return true;
}

bool ModalMemory::take(const Surface& surface, Time t, const Vec3& f) noexcept {
  if (!take_spectrum(surface) || !standing_ || foot_.version != version_) {
    restart();
    return false;
  }
  model_ = surface.model;
  take_series(surface.relaxed);
  if (!take_published(surface)) {
    restart();
    return false;
  }
  drift_.setZero();
  ModalState* before = past_.at(t);
  ModalState current;
  if (known_ && t > tick_) {  // without delay, the sample of this very tick
    advance(t);
    before = &(current = now(t));
  }
  present_ = published_.q;
  if (known_ && before != nullptr) {
    take_loads(surface.modal_loads, t);
    correct(*before, t);
    compared_ = t;
    if (!(at(state_.q).norm() <= kMaxSwing)) begin(t, f);
  } else if (!known_ || t - compared_ > kOutage) {
    take_loads(surface.modal_loads, t);
    begin(t, f);
  }  // else it stood nowhere yet at that time
  known_ = true;
  if (system_.terms > 0) {
    loads_.take(*model_, surface.relaxed, t);
    creep_at_foot();
  }
  return known_;
}

/// True if these are amplitudes of an organ.
bool ModalMemory::take_published(const Surface& surface) noexcept {
  const protocol::RelaxedState& relaxed = surface.relaxed;
  first_published_ = std::min<std::size_t>(relaxed.first, system_.count);
  end_published_ = std::min<std::size_t>(relaxed.first + relaxed.count, system_.count);
  for (std::size_t k = 0; k < system_.count; ++k) {
    published_.q[k] = static_cast<double>(surface.modes.q[k]);
    published_.v[k] = static_cast<double>(surface.modes.v[k]);
  }
  bool slight = at(published_.q).norm() <= kMaxSwing;
  for (std::size_t j = 0; j < system_.terms; ++j) {
    published_.z[j] = published_.q;  // the best guess of those that another sample tells of
    for (std::size_t k = first_published_; k < end_published_; ++k)
      published_.z[j][k] = static_cast<double>(relaxed.z[(k - first_published_) * system_.terms + j]);
    slight = slight && at(published_.z[j]).norm() <= kMaxSwing;
  }
  return slight;
}

/// The series that it relaxes by; with another, what was known of the old one is gone.
void ModalMemory::take_series(const protocol::RelaxedState& published) noexcept {
  std::array<Relaxation, kMostRelaxations> series{};
  for (std::size_t j = 0; j < published.terms; ++j)
    series[j] = {static_cast<double>(published.fraction[j]), static_cast<double>(published.time[j])};
  if (published.terms == system_.terms && series == system_.series) return;
  known_ = false;
  system_.terms = published.terms;
  system_.series = series;
  short_step_.prepare(to_seconds(kStep), system_);
  loads_.begin(time_, system_.relaxations());
  foot_.crept.setZero();
}

double ModalMemory::Trend::at(std::size_t mode, Time now) const noexcept {
  return load[mode] + to_seconds(std::clamp(now - t, Time::zero(), kTrend)) * rate[mode];
}

/// Loads that would lead the surface farther than any organ goes count as none. What two samples differ by
/// tells of the trend the less, the nearer they are.
void ModalMemory::take_loads(const protocol::ModalLoads& published, Time t) noexcept {
  others_.driven = published.count > 0 || others_.driven;
  if (!others_.driven) return;
  others_.before = others_.now;
  others_.now = {.t = t};
  ModalNumbers led{};
  const std::size_t count = std::min<std::size_t>(published.count, system_.count);
  for (std::size_t k = 0; k < count; ++k) {
    others_.now.load[k] = static_cast<double>(published.load[k]);
    led[k] = others_.now.load[k] / (system_.w[k] * system_.w[k]);
  }
  if (!(at(led).norm() <= kMaxSwing)) others_.now.load = {};
  const double interval = to_seconds(t - others_.before.t);
  if (!known_ || !(interval > 0 && interval < to_seconds(kTrend))) return;
  double change = 0, size = 0;  // squared
  for (std::size_t k = 0; k < system_.count; ++k) {
    const double now = others_.now.load[k], was = others_.before.load[k];
    change += (now - was) * (now - was);
    size += std::max(now * now, was * was);
  }
  if (change > kOther * kOther * size) return;  // one of them has come, or gone
  const double fraction = std::min(1.0, interval / to_seconds(kTrendBase));
  for (std::size_t k = 0; k < system_.count; ++k) {
    const double rate = (others_.now.load[k] - others_.before.load[k]) / interval;
    others_.now.rate[k] = others_.before.rate[k] + fraction * (rate - others_.before.rate[k]);
  }
}

void ModalMemory::creep_at_foot() noexcept {
  foot_.crept = system_.terms > 0 && standing_ && model_ != nullptr ? loads_.creep(*model_, foot_.vertex)
                                                                    : Vec3(Vec3::Zero());
  if (!(foot_.crept.norm() <= kMaxSwing)) restart();
}

void ModalMemory::begin(Time t, const Vec3& f) noexcept {
  state_ = published_;
  time_ = tick_ = tick_before_ = compared_ = t;
  bearing_ = foot_.shapes;
  force_ = force_of(f);
  past_.forget();
  if (system_.terms == 0) return;
  loads_.begin(t, system_.relaxations());
  const VertexLoad load{foot_.vertex, -f};
  loads_.apply_loads(*model_, {&load, 1}, 1);
  foot_.crept.setZero();
}

/// Corrects the modes by their error at the tick of the sample. It continues by itself, driven by no more
/// than what other tools are now thought to do otherwise than before. All ticks since are corrected with it,
/// so that a sample which tells of one of them does not count it again.
void ModalMemory::correct(ModalState& before, Time t) noexcept {
  drift_ = at(published_.q) - at(before.q);
  ModalState off;
  for (std::size_t k = 0; k < system_.count; ++k) {
    off.q[k] = published_.q[k] - before.q[k];
    off.v[k] = published_.v[k] - before.v[k];
  }
  for (std::size_t j = 0; j < system_.terms; ++j) {
    for (std::size_t k = first_published_; k < end_published_; ++k)
      off.z[j][k] = published_.z[j][k] - before.z[j][k];
  }
  add(off, before);
  if (!others_.driven) add(free_motion(off, to_seconds(time_ - t), system_), state_);
  Time reached = t;
  const auto publication = [&] {
    ModalNumbers force{};
    for (std::size_t k = 0; others_.driven && k < system_.count; ++k)
      force[k] = others_.now.at(k, reached + kStep / 2) - others_.before.at(k, reached + kStep / 2);
    return force;
  };
  bool added = !others_.driven;
  past_.for_each_since(t, [&](Time tick, ModalState& then) {
    for (; reached + kStep <= tick; reached += kStep) {
      if (!added && reached + kStep > time_) {
        add(soon(off, publication(), time_ - reached), state_);
        added = true;
      }
      short_step_.advance(off, publication());
    }
    add(soon(off, publication(), tick - reached), then);
  });
  if (!added) add(soon(off, publication(), time_ - reached), state_);
}

void ModalMemory::add(const ModalState& more, ModalState& state) const noexcept {
  for (std::size_t k = 0; k < system_.count; ++k) {
    state.q[k] += more.q[k];
    state.v[k] += more.v[k];
  }
  for (std::size_t j = 0; j < system_.terms; ++j) {
    for (std::size_t k = 0; k < system_.count; ++k) state.z[j][k] += more.z[j][k];
  }
}

bool ModalMemory::carry(const SurfaceModel& model, std::span<const VertexLoad> loads) noexcept {
  const Vec3 sum = sum_of(loads);
  if (!(sum.squaredNorm() > 0)) {
    bearing_ = foot_.shapes;
    return standing_;
  }
  std::fill_n(bearing_.begin(), system_.count, Vec3::Zero());
  return std::ranges::all_of(loads, [&](const VertexLoad& load) {
    return model.add_shapes(load.vertex, fraction_of(load, sum), bearing_);
  });
}

bool ModalMemory::place_near(const SurfaceModel& model, const Vec3& p_rest) noexcept {
  if (standing_ && foot_.version == model.generation() && (p_rest - foot_.at).norm() < kSamePlace)
    return true;
  if (!model.has_shape()) return standing_ = false;
  const auto rest = model.rest();
  int nearest = -1;
  double least = std::numeric_limits<double>::max();
  for (std::size_t v = 0; v < rest.size(); ++v) {
    const double distance = (rest[v] - p_rest).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    nearest = static_cast<int>(v);
  }
  foot_.at = p_rest;
  foot_.version = model.generation();
  foot_.vertex = nearest;
  std::ranges::fill(foot_.shapes, Vec3::Zero());
  standing_ = nearest >= 0 && model.add_shapes(nearest, 1, foot_.shapes);
  creep_at_foot();
  return standing_;
}

Vec3 ModalMemory::at(const ModalNumbers& q) const noexcept {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < system_.count; ++k) sum += q[k] * foot_.shapes[k];
  return sum;
}

/// Returns the modal forces of a force on the tool; the tissue feels the opposite.
ModalNumbers ModalMemory::force_of(const Vec3& f) const noexcept {
  ModalNumbers force{};
  for (std::size_t k = 0; k < system_.count; ++k) force[k] = -f.dot(bearing_[k]);
  return force;
}

void ModalMemory::advance(Time t) noexcept {
  if (t - time_ > kOutage) return restart();
  for (; time_ + kStep <= t; time_ += kStep)
    short_step_.advance(state_, others_.driven ? all_forces(time_ + kStep / 2) : force_);
  if (system_.terms > 0) {
    loads_.advance(t);
    creep_at_foot();
    if (!known_) return;
  }
  if (t > tick_) tick_before_ = tick_;  // else once more at the same tick, after a sample came
  tick_ = t;
  present_ = now(t).q;
}

/// Returns the state at a time up to a step after `time_`.
ModalState ModalMemory::now(Time t) const noexcept {
  return soon(state_, others_.driven ? all_forces(t) : force_, t - time_);
}

/// Returns the modal forces of the tool and of others.
ModalNumbers ModalMemory::all_forces(Time t) const noexcept {
  ModalNumbers force = force_;
  for (std::size_t k = 0; k < system_.count; ++k) force[k] += others_.now.at(k, t);
  return force;
}

/// Returns the state after the `rest` of a step, under a force that is held.
ModalState ModalMemory::soon(ModalState state, const ModalNumbers& force, Time rest) const noexcept {
  const double h = to_seconds(rest);
  const ModalNumbers from = state.q;
  for (std::size_t k = 0; k < system_.count; ++k) {
    double q = from[k];
    for (std::size_t j = 0; j < system_.terms; ++j) q -= system_.series[j].fraction * state.z[j][k];
    const double a = force[k] - system_.w[k] * system_.w[k] * q - system_.damping[k] * state.v[k];
    state.q[k] += h * (state.v[k] + 0.5 * h * a);
    state.v[k] += h * a;
  }
  for (std::size_t j = 0; j < system_.terms; ++j) {
    const RelaxationStep step = RelaxationStep::over(h, system_.series[j].time);
    for (std::size_t k = 0; k < system_.count; ++k)
      state.z[j][k] = step.followed(state.z[j][k], from[k], state.q[k]);
  }
  return state;
}

void ModalMemory::apply_loads(const Vec3& f, std::span<const VertexLoad> loads) noexcept {
  // From the last tick to this one the force went from the last to this, not all at once: the mean counts.
  const ModalNumbers force = force_of(f);
  const double half = 0.5 * to_seconds(tick_ - tick_before_);
  for (std::size_t k = 0; k < system_.count; ++k) state_.v[k] += half * (force[k] - force_[k]);
  ModalState* tick = past_.add(tick_);
  if (tick == nullptr) tick = past_.at(tick_);  // once more at the same tick: as it is now
  if (tick != nullptr) *tick = now(tick_);
  force_ = force;
  if (system_.terms == 0 || model_ == nullptr) return;
  const Vec3 sum = sum_of(loads);
  const double size = sum.squaredNorm();
  loads_.apply_loads(*model_, loads, size > 0 ? std::max(0.0, -f.dot(sum) / size) : 0);
}

}  // namespace palpate::client
