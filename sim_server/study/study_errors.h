#pragma once
#include "common/error_table.h"
#include "common/force_jumps.h"
#include "sim_server/study/study_run.h"

namespace palpate::sim {

/// Error of a case against the reference, %.
struct StudyErrors {
  /// Mean of |F - F_ref| over the steps in which either touches, of the root mean square of F_ref there.
  double force = 0;
  double worst_force = 0;  ///< the largest |F - F_ref| of a step, of the same
  /// Root mean square over all sites and steps of |u - u_ref|, of that of u_ref.
  double surface = 0;
  /// Error of the force that a client renders at 1 kHz, by the definitions of a session. Each step starts
  /// with the tool's place then, takes its full `dt`, and its force comes `latency` later. The client
  /// extrapolates with its tangent: F + K (x(t) - x of the step).
  ErrorMetrics rendered = {};
  std::vector<double> along;  ///< (steps) |F - F_ref|, of the same root mean square
};

/// Returns the jumps between the steps of a trace that its tangents do not explain. Only for supports that
/// rest: a trace does not hold how the tissue moves by itself.
std::optional<ForceJumps> unexplained_jumps(const Trace& trace);

/// Error of the force of a scene as it is, % of the root mean square of the reference.
struct SplitError {
  double mesh = 0;       ///< that would be left with steps of no length
  double time_step = 0;  ///< of the force from there
};
/// Splits the error of a trace by one with shorter steps, a whole number of them in each of `own`: what steps
/// cost goes with their length to the power of `order` (Richardson 1911, Phil. Trans. A 210:307). The error
/// by the mesh is that at the ends of the shorter steps, which look at the motion more often.
SplitError split_error(const Trace& own, const Trace& shorter, int order, const Trace& reference,
                       const Trajectory& motion);

/// Every step of the trace must end where one of the reference does, but for rounding; `latency` in s.
StudyErrors errors_of(const Trace& trace, const Trace& reference, const Trajectory& motion, double latency);

}  // namespace palpate::sim
