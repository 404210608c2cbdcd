#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "common/time.h"

namespace palpate::protocol {

/// Conditions of one direction of a link. Fractions are from 0 to 1, of the datagrams sent; s, bytes.
struct LinkConditions {
  /// Delay (s) of every datagram from time `from` on.
  struct DelayStep {
    Time from{};
    double delay = 0;
  };
  /// Nothing that is sent from `from` until `until` arrives.
  struct Partition {
    Time from{}, until{};
  };
  double delay = 0;          ///< s
  double jitter = 0;         ///< s: more delay, even between 0 and this, drawn for each; so they may overtake
  double loss = 0;           ///< share lost, each on its own
  double burst_start = 0;    ///< share, outside bursts, with which a burst of losses begins (Gilbert 1960,
                             ///< Bell Syst. Tech. J. 39:1253)
  double burst_end = 1;      ///< share of those in a burst that are its last: 1 / (mean length)
  double duplicates = 0;     ///< share that arrives twice, each with its own jitter
  double reordered = 0;      ///< share held back by `reorder_delay` behind those sent after it
  double reorder_delay = 0;  ///< s
  double corrupted = 0;      ///< share of which one byte, anywhere, has another value
  double bandwidth = 0;      ///< bytes/s, one datagram after the other; 0: any
  double queue = 0.2;        ///< s of bandwidth that may wait; what would wait longer is dropped
  std::vector<DelayStep> delay_steps = {};  ///< instead of `delay`, times ascending
  std::vector<Partition> partitions = {};
};

/// Datagrams, each counted under what became of it when it was sent.
struct LinkCounts {
  std::uint64_t sent = 0, lost = 0, lost_in_bursts = 0, dropped_by_queue = 0, partitioned = 0;
  std::uint64_t duplicated = 0, reordered = 0, corrupted = 0, delivered = 0;
};

/// Simulator of one direction of a bad network, in virtual time: datagrams enter and leave as its conditions
/// say. Pure: no clock, no socket; equal seeds and calls return equal results on every machine. Each datagram
/// draws an equal number of random numbers whatever the conditions, so that a change of one leaves the rest
/// as it was. For tests and studies; allocates. One thread.
class LinkSimulator {
 public:
  LinkSimulator(LinkConditions conditions, std::uint64_t seed)
      : conditions_(std::move(conditions)), random_(seed) {}

  /// Takes a datagram on its way at `now`; times do not go back.
  void send(std::span<const std::byte> datagram, Time now);
  /// The datagram that arrived first, at `now` or before; of equal times the one sent first.
  std::optional<std::vector<std::byte>> receive(Time now);

  /// When the next one arrives; none on the way: nothing.
  std::optional<Time> next_arrival() const;
  const LinkCounts& counts() const { return counts_; }

 private:
  struct InTransit {
    Time arrival;
    std::vector<std::byte> datagram;
  };
  struct Draws {
    double loss, burst_start, burst_end, duplicate, reorder, corrupt, byte, value, jitter, second_jitter;
  };
  double draw();
  bool gets_through(const Draws& draws, Time now);
  std::optional<Time> leaves(std::size_t bytes, Time now);
  void put(Time arrival, std::vector<std::byte> datagram);

  LinkConditions conditions_;
  std::mt19937_64 random_;
  bool in_burst_ = false;
  Time line_free_{};                   // when the last datagram in the queue has left
  std::vector<InTransit> in_transit_;  // by arrival, the next one last
  LinkCounts counts_;
};

}  // namespace palpate::protocol
