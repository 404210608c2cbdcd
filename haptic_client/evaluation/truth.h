#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "common/force_jumps.h"
#include "common/time.h"
#include "common/types.h"
#include "protocol/messages.h"

namespace palpate::client {

/// The force that would have been right at any time: the samples of a capture that was made at a high rate on
/// the same motion (`sim_server record --rate 2000 --plain`). 64 bytes a sample.
class Truth {
 public:
  /// Reads the longest session. Throws `Error` when the capture cannot be read, has less than 200 samples a
  /// second, or more flagged samples than others.
  Truth(const std::filesystem::path& file, const std::function<void(double fraction)>& progress);

  /// Force (N, world) at `t` (client clock), on the line between the samples around it; none outside them,
  /// or where one of them is flagged: its force was held, not computed.
  /// Times that grow are found at once.
  std::optional<Vec3> at(Time t) const noexcept;
  /// Returns how far from `p` (m, world) the tool of the truth was at `t`; none outside its samples.
  std::optional<double> distance(const Vec3& p, Time t) const noexcept;
  double rate_hz() const noexcept { return rate_hz_; }
  std::size_t samples() const noexcept { return points_.size(); }
  std::size_t flagged() const noexcept;  ///< samples
  /// Scene of its forces; nothing where the capture does not tell.
  const std::optional<protocol::ScenePrint>& scene() const noexcept { return scene_; }
  /// Snaps of the force over the whole capture; nothing where it has fewer than 2000 samples a second.
  std::optional<ForceJumps> snaps() const;

 private:
  struct Point {
    Time t;
    Vec3 p, f;
    bool flagged;
  };
  std::optional<double> find(Time t) const noexcept;
  std::vector<Point> points_;
  mutable std::size_t hint_ = 0;
  double rate_hz_ = 0;
  std::optional<protocol::ScenePrint> scene_;
};

}  // namespace palpate::client
