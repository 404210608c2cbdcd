#pragma once
#include <algorithm>
#include <cstdint>

#include "protocol/link_stats.h"

namespace palpate::protocol {

/// Tells a sender that has gone elsewhere with its numbers from a single number that is wild: of several in a
/// row that are far off, each a little beyond the one before, the last begins anew (as RFC 3550, appendix
/// A.1, does with two). One that is wild then silences nobody. Pure; a few instructions.
class Stray {
 public:
  /// A number that is far off came. True: it is the fourth of a row.
  bool is_new_beginning(std::uint64_t number) noexcept {
    const bool continues = in_a_row_ > 0 && number > last_ && number - last_ <= kNear;
    in_a_row_ = continues ? in_a_row_ + 1 : 1;
    last_ = number;
    if (in_a_row_ < kEnough) return false;
    in_a_row_ = 0;
    return true;
  }
  /// Ends the row, as a number in the expected range came.
  void end_row() noexcept { in_a_row_ = 0; }

  static constexpr int kEnough = 4;           // in a row: the sender began again
  static constexpr std::uint64_t kNear = 64;  // in a row: the width of the window

 private:
  std::uint64_t last_ = 0;
  int in_a_row_ = 0;
};

/// Sequence numbers of one sender seen so far: the highest, and which of the 63 before it (the sliding window
/// of RFC 4303, section 3.4.3). Pure; a few instructions.
class ReplayWindow {
 public:
  /// `furthest`: how far ahead a number is taken at once. One that is wild within that keeps the sender out
  /// until its own numbers get there: about a second of them.
  explicit ReplayWindow(std::uint64_t furthest) : furthest_(furthest) {}

  /// True if `sequence` (>= 1) was not seen before; counts it in `stats`. A duplicate, a number 64 or more
  /// behind, or one farther ahead than `furthest`, is refused; the latter until the sender goes on from there
  /// (`Stray`). Sequence 0 is refused always.
  bool accept(std::uint64_t sequence, LinkStats& stats) noexcept {
    in_order_ = false;
    if (sequence == 0) return refuse(stats);
    const std::uint64_t ahead = sequence > highest_ ? sequence - highest_ : 0;
    if (ahead > 0) {
      if (ahead > furthest_) {
        if (!stray_.is_new_beginning(sequence)) {
          ++stats.implausible;
          return false;
        }
        ++stats.began_anew;
      } else {
        stats.lost += ahead - 1;  // where it begins anew, nobody knows how many there were
      }
      seen_ = ahead >= 64 ? 0 : seen_ << ahead;
      seen_ |= 1;
      highest_ = sequence;
      in_order_ = true;
    } else {
      const std::uint64_t behind = highest_ - sequence;
      if (behind >= 64 || (seen_ >> behind & 1) != 0) return refuse(stats);
      seen_ |= std::uint64_t{1} << behind;
      if (stats.lost > 0) --stats.lost;  // it was counted as lost when a later one came
      ++stats.reordered;
    }
    stray_.end_row();
    ++stats.received;
    return true;
  }
  /// Returns the highest number taken; 0: none yet.
  std::uint64_t highest() const noexcept { return highest_; }
  /// True if the last number taken is the highest.
  bool in_order() const noexcept { return in_order_; }
  /// The sender, as it says itself, is at `sequence` only: the next number is that or higher, and all below
  /// were seen.
  void go_back_to(std::uint64_t sequence) noexcept {
    if (highest_ < sequence) return;
    highest_ = sequence - 1;
    seen_ = ~std::uint64_t{0};
  }
  /// The sender has gone on so far unseen: the next number is `sequence`.
  void start_at(std::uint64_t sequence) noexcept { highest_ = sequence - 1; }

 private:
  static bool refuse(LinkStats& stats) noexcept {
    ++stats.duplicated;
    return false;
  }

  std::uint64_t furthest_, highest_ = 0, seen_ = 0;
  Stray stray_;
  bool in_order_ = false;
};

/// Lets through values that are newer than all before, by their numbers.
class NewestOnly {
 public:
  /// `sequence`: of its datagram; `in_order`: that is the highest so far. One that only datagrams of other
  /// kinds overtook is the newest still. False also of one whose number is wild, until the sender goes on
  /// from there (`Stray`). Counts in `stats` what was dropped, and the values between this and the one
  /// before, which are lost or will be overtaken.
  bool accept(std::uint64_t number, std::uint64_t sequence, bool in_order, LinkStats& stats) noexcept {
    if (!in_order && sequence <= sequence_) {
      ++stats.overtaken;
      if (stats.values_lost > 0) --stats.values_lost;  // counted as lost when the newer one came
      return false;
    }
    const bool newer = newest_ == 0 || (number > newest_ && number - newest_ <= kMaxDistance);
    if (!newer && !stray_.is_new_beginning(number)) {
      ++stats.implausible;
      return false;
    }
    if (newer) {
      stray_.end_row();
      // A value takes a datagram: no more were lost than those, however far its number jumps. Where their
      // numbers began anew, nobody knows how many there were.
      if (newest_ > 0 && began_anew_ == stats.began_anew && sequence > sequence_)
        stats.values_lost += std::min(number - newest_, sequence - sequence_) - 1;
    }
    newest_ = number;
    sequence_ = sequence;
    began_anew_ = stats.began_anew;
    return true;
  }

  /// Returns the number of the newest value, 0 before there is one.
  std::uint64_t newest() const noexcept { return newest_; }

 private:
  static constexpr std::uint64_t kMaxDistance = 1 << 16;  // 131 s of ticks at 500 Hz

  std::uint64_t newest_ = 0, sequence_ = 0, began_anew_ = 0;
  Stray stray_;
};

}  // namespace palpate::protocol
