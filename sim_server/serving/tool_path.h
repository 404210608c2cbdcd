#pragma once
#include <array>
#include <cstddef>
#include <optional>

#include "protocol/messages.h"
#include "sim_server/contact/tool_contact.h"

namespace palpate::sim {

/// The pose in a tool state; an orientation that is none is taken for no turn.
ToolPose pose_of(const protocol::ToolState& state) noexcept;

/// Recent path of a tool, from the tool states that its client sends each tick, by the client's clock. No
/// allocation; copied between threads as one value, 6 kB.
class ToolPath {
 public:
  /// The newest state; one that is not later than those before changes nothing, but where it is earlier by
  /// more than a second all begins anew. States that follow each other by less than `kSpacing` are thinned,
  /// so that the last 126 ms are known whatever the rate of the client.
  void add(const protocol::ToolState& state) noexcept;

  struct Point {
    std::int64_t t_ns = 0;
    ToolPose pose;
    Vec3 v_W = Vec3::Zero();  // m/s
  };
  /// Returns the newest point; nothing before the first state.
  std::optional<Point> newest() const noexcept {
    return written_ > 0 ? std::optional(back(0)) : std::nullopt;
  }
  /// Returns the point at a time from the oldest known state to the newest, linear between two of them;
  /// nothing at other times.
  std::optional<Point> at(std::int64_t t_ns) const noexcept;

 private:
  static constexpr std::size_t kPoints = 64;  // 63 intervals of 2 ms are 126 ms: four steps at 30 Hz
  static constexpr std::uint64_t kSpacing = 2'000'000;  // ns

  const Point& back(std::size_t i) const noexcept { return ring_[(written_ - 1 - i) % kPoints]; }

  std::array<Point, kPoints> ring_;
  std::size_t written_ = 0;
};

}  // namespace palpate::sim
