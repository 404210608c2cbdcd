#pragma once
#include <deque>

#include "tests/emulation/vec.h"

namespace palpate::emulation {

/// A hand on the grip: a spring and a damper towards a target that moves along minimum-jerk paths. Device
/// frame, SI.
class Hand {
 public:
  double stiffness = 300;  ///< N/m, 0 or more; 0 and no damping: the hand has let go
  double damping = 10;     ///< N s/m, 0 or more
  double tremor = 0;       ///< m, amplitude along the three axes, 0 or more
  double tremor_rate = 8;  ///< Hz, (0, 50]

  /// Goes to `target` in `seconds` from where the hand is now, and forgets moves that waited. 0 s: at once.
  void move(const Vec& target, double seconds);
  /// The same, after all moves that wait.
  void then(const Vec& target, double seconds) { waiting_.push_back({target, seconds}); }
  /// True when no move is under way and none waits.
  bool at_rest() const { return elapsed_ >= seconds_ && waiting_.empty(); }

  void advance(double dt);
  /// Where the hand wants to be (m) and how fast that moves (m/s).
  Vec target() const { return target_at(elapsed_); }
  Vec target_velocity() const;
  /// N on the grip.
  Vec force(const Vec& position, const Vec& velocity) const;

 private:
  struct Move {
    Vec target;
    double seconds = 0;
  };
  Vec target_at(double elapsed) const;
  Vec tremor_at(double time) const;
  void begin(const Move& move, const Vec& from);

  Vec from_, to_;
  double elapsed_ = 0, seconds_ = 0, time_ = 0;  // s
  std::deque<Move> waiting_;
};

}  // namespace palpate::emulation
