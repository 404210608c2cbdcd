#pragma once
#include <optional>
#include <string_view>

#include "haptic_client/extrapolation/extrapolator.h"

namespace palpate::client {

/// Kind of reference for the force between two samples, the least accurate first.
enum class ReferenceKind { kLine, kHermite, kContact };
inline constexpr std::size_t kReferenceKinds =
    static_cast<std::size_t>(ReferenceKind::kContact) + 1;  // the last, and 0
std::string_view name_of(ReferenceKind kind) noexcept;

/// A tick between two samples, with the contact that was solved for it (`FollowedContact`).
struct PathTick {
  Time t{};
  Vec3 p = Vec3::Zero();  ///< m, world
  struct Contact {
    Vec3 shift = Vec3::Zero(), force = Vec3::Zero();  ///< of the organ, m, as it was thought to be then; N
    Mat3 tangent = Mat3::Zero();                      ///< N/m
  };
  std::optional<Contact> contact = {};
};

/// The force on the path that the tool really took between two samples, from what both bring. Three ways, the
/// first of which the samples bring enough for:
///   contact  F_loc, the contact solved on the model of the surface at every tick, corrected at both ends as
///            `LocalContact` corrects it at one, the corrections blended linearly in time
///   hermite  with d = x - x_n, D = x_(n+1) - x_n, s the share of the path that is done, w = s^2 (3 - 2 s):
///              F = F_n + K_n d + s (K_(n+1) - K_n) (d - s D / 2) + w c,
///              c = F_(n+1) - F_n - (K_n + K_(n+1)) D / 2
///            which on a straight path is the cubic through both forces with both slopes, and off it is right
///            to the first order across. x is the place on the organ, which goes between the samples as
///            their velocities say. Where one sample is free, the power of the depth beyond its plane that
///            has the force and the slope of the other (1.5 of a sphere on an elastic body)
///   line     in time from F_n to F_(n+1): the reference of Picinbono and Lombardo (1999), section 4; where
///            samples bring no tangents, or these miss more than the force changes
/// Haptic thread; no allocation. Usage: the constructor, `add` for all ticks, `close`, `at` for all ticks in
/// the same order.
class BetweenSamples {
 public:
  BetweenSamples(const Sample& before, const Sample& after) noexcept;

  /// A tick t_n <= t < t_(n+1), in the order of time.
  void add(const PathTick& tick) noexcept;
  /// No more ticks; `last`: that at t_(n+1), or near it.
  void close(const PathTick& last) noexcept;

  /// The force at a tick, N; in the order of time.
  Vec3 at(const PathTick& tick) noexcept;
  ReferenceKind kind() const noexcept { return kind_; }
  Vec3 line(Time t) const noexcept { return before_.f + fraction(t) * (after_.f - before_.f); }

 private:
  struct End {
    bool pushes = false;
    Vec3 f, local, across;  // N: the server's, that of the model, and what is missing of it
    double kappa = 1, size = 0;
  };
  double fraction(Time t) const noexcept {
    return to_seconds(t - before_.t) / to_seconds(after_.t - before_.t);
  }
  Vec3 organ(Time t) const noexcept;
  Vec3 on_organ(const PathTick& tick) const noexcept { return tick.p - organ(tick.t); }
  bool has_slopes() const noexcept;
  Vec3 local(const PathTick& tick) const noexcept;
  End end_of(const PathTick& tick, const Sample& sample) const noexcept;
  static Vec3 corrected(const End& end, const Vec3& local) noexcept;
  bool ends_agree(const PathTick& last) noexcept;
  Vec3 contact(const PathTick& tick) const noexcept;
  Vec3 hermite(const Vec3& x, double fraction) const noexcept;
  Vec3 onset(const Vec3& x) const noexcept;

  const Sample &before_, &after_;
  Vec3 end_, missed_;  // D, m; c, N
  ReferenceKind kind_ = ReferenceKind::kLine;
  bool solved_ = true;  // at every tick so far
  std::optional<PathTick> first_;
  End ends_[2];
  Vec3 place_ = Vec3::Zero();  // of the tick before, on the organ, m
  double length_ = 0, done_ = 0;
};

}  // namespace palpate::client
