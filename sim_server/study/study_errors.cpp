#include "sim_server/study/study_errors.h"

#include <algorithm>
#include <cmath>

namespace palpate::sim {
namespace {

constexpr double kTick = 1e-3;          // s, of the client
constexpr double kContactForce = 1e-6;  // N

/// The step of the reference that ends when step `k` of the trace does.
std::size_t same_time(const Trace& trace, const Trace& reference, std::size_t k) {
  const auto end = std::llround(static_cast<double>(k + 1) * trace.dt / reference.dt);
  return std::min(static_cast<std::size_t>(std::max(1LL, end)), reference.forces.size()) - 1;
}

/// A mean of |F - F_ref| over contact, of the root mean square of F_ref.
struct RelativeError {
  double sum = 0, squares = 0;
  int count = 0;

  void add(const Vec3& force, const Vec3& truth) {
    if (std::max(force.norm(), truth.norm()) < kContactForce) return;
    sum += (force - truth).norm();
    squares += truth.squaredNorm();
    ++count;
  }
  double rms() const { return count == 0 ? 0 : std::sqrt(squares / count); }
  double percent() const { return squares > 0 ? 100 * sum / count / rms() : 0; }
};

/// Returns the force between the ends of steps.
Vec3 force_at(const Trace& reference, double t) {
  const double at = std::clamp(t / reference.dt - 1, 0.0, static_cast<double>(reference.forces.size() - 1));
  const auto before = static_cast<std::size_t>(at);
  const std::size_t after = std::min(before + 1, reference.forces.size() - 1);
  const double fraction = at - static_cast<double>(before);
  return (1 - fraction) * reference.forces[before] + fraction * reference.forces[after];
}

/// Without force below `kContactForce`, as where contact only just ended.
Vec3 contact_force(const Vec3& force) {
  return force.norm() < kContactForce ? Vec3::Zero() : force;
}

ErrorMetrics rendered_error(const Trace& trace, const Trace& reference, const Trajectory& motion,
                            double latency) {
  ErrorTable error(1 / kTick);
  const double end = reference.dt * static_cast<double>(reference.forces.size());
  for (int tick = 0; tick * kTick <= end; ++tick) {
    const double t = tick * kTick;
    // Step k took the place of (k + 1) dt, worked for dt, and its force travelled.
    const double newest = std::floor((t - latency) / trace.dt - 2 + 1e-9);
    Vec3 force = Vec3::Zero();
    if (newest >= 0) {
      const std::size_t k = std::min(static_cast<std::size_t>(newest), trace.forces.size() - 1);
      force = trace.forces[k] + trace.tangents[k] * (motion.at(t) - trace.places[k]);
    }
    error.add(contact_force(force), ReferenceForce(contact_force(force_at(reference, t)), from_seconds(t)));
  }
  return error.metrics();
}

}  // namespace

std::optional<ForceJumps> unexplained_jumps(const Trace& trace) {
  UnexplainedJumps jumps;
  for (std::size_t k = 0; k < trace.forces.size(); ++k) {
    jumps.add({.number = k + 1,
               .t = from_seconds(static_cast<double>(k + 1) * trace.dt),
               .p = trace.places[k],
               .f = trace.forces[k],
               .tangent = trace.tangents[k]});
  }
  return jumps.jumps();
}

SplitError split_error(const Trace& own, const Trace& shorter, int order, const Trace& reference,
                       const Trajectory& motion) {
  const double fraction = 1 / (std::pow(own.dt / shorter.dt, order) - 1);  // that shorter steps leave
  Trace correction = own, limit = shorter;
  for (std::size_t k = 0; k < own.forces.size(); ++k)
    correction.forces[k] = fraction * (shorter.forces[same_time(own, shorter, k)] - own.forces[k]);
  for (std::size_t k = 0; k < limit.forces.size(); ++k) {
    const double t = static_cast<double>(k + 1) * limit.dt;
    limit.forces[k] += std::min(1.0, t / own.dt) * force_at(correction, t);  // a run begins without a force
  }
  return {errors_of(limit, reference, motion, 0).force, errors_of(own, limit, motion, 0).force};
}

StudyErrors errors_of(const Trace& trace, const Trace& reference, const Trajectory& motion, double latency) {
  RelativeError force;
  double off = 0, moved = 0;
  for (std::size_t k = 0; k < trace.forces.size(); ++k) {
    const std::size_t r = same_time(trace, reference, k);
    force.add(trace.forces[k], reference.forces[r]);
    for (std::size_t s = 0; s < trace.sites; ++s) {
      const Vec3 &u = trace.moved[k * trace.sites + s], &truth = reference.moved[r * reference.sites + s];
      off += (u - truth).squaredNorm();
      moved += truth.squaredNorm();
    }
  }
  StudyErrors errors{.force = force.percent(),
                     .surface = moved > 0 ? 100 * std::sqrt(off / moved) : 0,
                     .rendered = rendered_error(trace, reference, motion, latency),
                     .along = {}};
  for (std::size_t k = 0; k < trace.forces.size(); ++k) {
    const double away = (trace.forces[k] - reference.forces[same_time(trace, reference, k)]).norm();
    errors.along.push_back(force.rms() > 0 ? 100 * away / force.rms() : 0);
    errors.worst_force = std::max(errors.worst_force, errors.along.back());
  }
  return errors;
}

}  // namespace palpate::sim
