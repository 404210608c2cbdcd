#pragma once
#include "sim_server/viewer/showing_maker.h"

namespace palpate::sim {

/// Records that a page would have got of a session, one after the other (MESSAGES.md, "Sessions in a file"),
/// so that it can be played and searched. Time is the session's own. Holds all of it in memory.
class RecordedSession {
 public:
  /// `scene` outlives this.
  explicit RecordedSession(const SceneFacts& scene);

  /// Returns the picture to fill before `add`: completely, but for its positions where the organ did not
  /// move.
  Picture& picture() noexcept { return picture_; }
  /// Adds what a page gets of it at `t` >= those before; at least `PageLink::kSurfaceEach` apart it gets all.
  /// False where the session would be longer than `kLongest`, and nothing is added.
  bool add(Time t);

  const Bytes& bytes() const { return bytes_; }

  static constexpr std::size_t kLongest = std::size_t{1} << 30;          ///< bytes
  static constexpr Time kCompleteEach = std::chrono::milliseconds(900);  ///< a whole surface

 private:
  void put(PageLink::Kind kind, Time t, const Bytes& message);

  ViewerFeed feed_;
  ShowingMaker maker_;
  PageLink link_;
  Picture picture_;
  Time complete_at_{};
  Bytes bytes_, message_;
};

}  // namespace palpate::sim
