#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "common/contact/linearisation.h"
#include "common/contact/tool.h"
#include "common/damped_mode.h"
#include "common/time.h"
#include "common/types.h"
#include "protocol/codec.h"

namespace palpate::client {

class SurfaceModel;

/// Model and state of the surface near the tool.
struct Surface {
  const SurfaceModel* model = nullptr;  ///< never null; learns between samples
  Vec3 shift = Vec3::Zero();            ///< from rest to where it is, free of the tool, m
  Tool tool;
  double tool_compliance = 0;  ///< m/N
  /// State of the slow modes of a body in motion; the surface model then covers the remaining compliance.
  struct Modes {
    int count = 0;                                   ///< 0: it does not swing, or none are published
    std::array<float, kMaxPublishedModes> q{}, v{};  ///< m sqrt(kg), m sqrt(kg)/s
  } modes = {};
  protocol::RelaxedState relaxed = {};    ///< some of what it remembers besides; without terms: nothing
  protocol::ModalLoads modal_loads = {};  ///< how hard other tools drive the modes, N/sqrt(kg)
};

/// Sample of the simulation: the triplet (t_n, P_n, F_n) of Picinbono and Lombardo (1999), and what a law
/// requested beyond it.
struct Sample {
  std::uint64_t number = 0;                   ///< of the sample, from 1
  Time t{};                                   ///< when the tool was at `p`, client clock
  Vec3 p = Vec3::Zero();                      ///< tool position, m, world
  Vec3 f = Vec3::Zero();                      ///< force on the tool there, N, world
  Vec3 surface_v = Vec3::Zero();              ///< of the organ there, by all that moves it, m/s, world
  std::optional<Linearisation> at_tool = {};  ///< at `p`
  std::optional<Linearisation> ahead = {};    ///< where the tool was expected by now
  std::optional<Surface> surface = {};
  std::optional<OtherTools> others = {};  ///< what `surface_v` has of them, and more
  std::uint32_t cuts = 0;                 ///< in how many steps so far tissue has been removed
  bool cutting = false;                   ///< by this tool: what it touches may give way at any time
  bool settled = true;                    ///< false: the server flags `f`, which is then no truth
};

/// True if a law may use the sample at all: its vectors are finite.
inline bool usable(const Sample& sample) noexcept {
  return sample.p.allFinite() && sample.f.allFinite();
}

/// A force `f` by a law that began from the force `rendered`, without what of it would pull: there is none
/// where the part of `f` along `rendered` is gone or turned about. What lies across `rendered`, as of
/// friction, goes to nothing with that part, from a fifth of `rendered` on, so that no force ends at once.
inline Vec3 without_pull(const Vec3& f, const Vec3& rendered) noexcept {
  constexpr double kFraction = 0.2;  // of `rendered`
  const double size = rendered.norm();
  if (!(size > 0) || !(f.dot(rendered) > 0)) return Vec3::Zero();
  const double fraction = f.dot(rendered) / (kFraction * size * size);
  if (!(fraction < 1)) return f;
  const Vec3 along = f.dot(rendered) / (size * size) * rendered;
  return along + fraction * (f - along);
}

/// True if a law may use this part of a sample: it is within the bounds of the protocol, what a server can
/// mean in SI units.
inline bool usable(const Linearisation& l) noexcept {
  const auto bounded = [](const auto& m) { return (m.array().abs() <= protocol::kMaxMagnitude).all(); };
  return bounded(l.p_W) && bounded(l.f_W) && bounded(l.tangent) && bounded(l.normal_W) && l.gap >= 0 &&
         l.gap <= protocol::kMaxMagnitude;
}
inline bool usable(const Surface& s) noexcept {
  const Tool& tool = s.tool;
  const auto bounded = [](float x) { return std::abs(x) <= 1e6F; };
  const auto& modes = s.modes;
  const auto n = static_cast<std::size_t>(modes.count);
  return modes.count >= 0 && n <= modes.q.size() &&
         std::all_of(modes.q.begin(), modes.q.begin() + n, bounded) &&
         std::all_of(modes.v.begin(), modes.v.begin() + n, bounded) &&
         (s.shift.array().abs() <= protocol::kMaxMagnitude).all() && tool.is_sphere() && tool.radius > 0 &&
         tool.radius <= 1 && tool.friction >= 0 && tool.friction <= 10 && s.tool_compliance >= 0 &&
         s.tool_compliance <= 1e6 && protocol::valid(s.relaxed) && protocol::valid(s.modal_loads);
}
inline bool usable(const OtherTools& o) noexcept {
  return (o.v_W.array().abs() <= protocol::kMaxMagnitude).all() && (o.compliance.array().abs() <= 1e6).all();
}
/// The sample without those parts that are not.
inline Sample with_usable_parts(Sample sample) noexcept {
  if (sample.at_tool && !usable(*sample.at_tool)) sample.at_tool.reset();
  if (sample.ahead && !usable(*sample.ahead)) sample.ahead.reset();
  if (sample.surface && !usable(*sample.surface)) sample.surface.reset();
  if (sample.others && !usable(*sample.others)) sample.others.reset();
  return sample;
}

/// Parts of a sample that a law can use; `errors` are for reports.
struct Request {
  bool at_tool = false, ahead = false, surface = false, errors = false;
  Request& operator|=(const Request& other) {
    at_tool = at_tool || other.at_tool;
    ahead = ahead || other.ahead;
    surface = surface || other.surface;
    errors = errors || other.errors;
    return *this;
  }
};

/// Estimates the force between two samples. Haptic thread only; no allocation, lock or exception. Whatever
/// it is given, the answer is finite; each law's header says what it is where the formula has none.
class Extrapolator {
 public:
  virtual ~Extrapolator() = default;
  /// A new sample, usually later than the one before (`ForceEstimate` sees to it). One that is not `usable`
  /// changes nothing; a part that is not counts as missing.
  virtual void update(const Sample& sample) noexcept = 0;
  /// Forgets all samples: what came before is too long ago to look back at.
  virtual void restart() noexcept = 0;
  /// Forgets all samples, as tissue has been removed since: no line leads from them to the next. What was
  /// learned of other things than the surface may stay.
  virtual void surface_cut() noexcept { restart(); }
  /// Force (N, world) with the tool at `p` at time `t` >= that of the newest sample. Zero before the first
  /// sample. |p| and |f| up to 1e30 give a finite answer; times are from 0 to 2^62 ns.
  /// Called tick by tick: a law may go along with the tool. `t` itself runs back where samples stay out
  /// (`start_tick` has the time of the tick).
  virtual Vec3 force(const Vec3& p, Time t) noexcept = 0;
  /// `force` follows for a tick at `now`; the time of `force` stands still, or runs back, where samples stay
  /// out.
  virtual void start_tick(Time) noexcept {}
  /// Returns what the law uses beyond the triplet. A law that uses any of it distinguishes a free surface
  /// from one that pulls.
  virtual Request request() const noexcept { return {}; }
  /// True if a simpler law replaces it, because the newest sample lacks what it uses.
  virtual bool stepped_down() const noexcept { return false; }
  /// The name of that law, a row of `extrapolators()`; empty: it is at work itself.
  virtual std::string_view substitute() const noexcept { return {}; }
};

/// Counts the ticks in which each simpler law replaced another one.
class Substitutes {
 public:
  struct Row {
    std::string_view law;
    std::uint64_t ticks = 0;
  };
  /// A tick, in which `law` stood in; empty: none did.
  void add(std::string_view law) noexcept {
    if (law.empty()) return;
    for (Row& row : rows_) {
      if (!row.law.empty() && row.law != law) continue;
      row.law = law;
      ++row.ticks;
      return;
    }
  }
  /// Without a name: not used.
  std::span<const Row> rows() const noexcept { return rows_; }

 private:
  std::array<Row, 8> rows_{};  // as many as `best_recent` has
};

/// The two newest samples, which is all that the paper's laws know. A sample that is not `usable`, or not
/// later than the newest, changes nothing.
struct LastTwo {
  Sample newest, before;
  int count = 0;
  void push(const Sample& sample) noexcept {
    if (!usable(sample) || (count > 0 && sample.t <= newest.t)) return;
    before = newest;
    newest = sample;
    if (count < 2) ++count;
  }
};

}  // namespace palpate::client
