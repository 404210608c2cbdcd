#include "protocol/link_simulator.h"

#include <algorithm>

namespace palpate::protocol {

/// Even on [0, 1), the same on every machine (the distributions of the standard are not).
double LinkSimulator::draw() {
  return static_cast<double>(random_() >> 11) * 0x1.0p-53;
}

void LinkSimulator::send(std::span<const std::byte> datagram, Time now) {
  ++counts_.sent;
  Draws draws{};
  for (double* each : {&draws.loss, &draws.burst_start, &draws.burst_end, &draws.duplicate, &draws.reorder,
                       &draws.corrupt, &draws.byte, &draws.value, &draws.jitter, &draws.second_jitter})
    *each = draw();
  if (!gets_through(draws, now)) return;
  const std::optional<Time> leaving = leaves(datagram.size(), now);
  if (!leaving) {
    ++counts_.dropped_by_queue;
    return;
  }
  std::vector<std::byte> bytes(datagram.begin(), datagram.end());
  if (draws.corrupt < conditions_.corrupted && !bytes.empty()) {
    ++counts_.corrupted;
    auto& byte = bytes[static_cast<std::size_t>(draws.byte * static_cast<double>(bytes.size()))];
    byte ^= static_cast<std::byte>(1 + static_cast<int>(draws.value * 255));
  }
  double delay = conditions_.delay;
  for (const auto& step : conditions_.delay_steps) {
    if (step.from <= now) delay = step.delay;
  }
  if (draws.reorder < conditions_.reordered) {
    ++counts_.reordered;
    delay += conditions_.reorder_delay;
  }
  if (draws.duplicate < conditions_.duplicates) {
    ++counts_.duplicated;
    put(*leaving + from_seconds(delay + draws.second_jitter * conditions_.jitter), bytes);
  }
  put(*leaving + from_seconds(delay + draws.jitter * conditions_.jitter), std::move(bytes));
}

bool LinkSimulator::gets_through(const Draws& draws, Time now) {
  const bool burst = in_burst_ || draws.burst_start < conditions_.burst_start;
  in_burst_ = burst && draws.burst_end >= conditions_.burst_end;
  const bool cut = std::ranges::any_of(conditions_.partitions,
                                       [&](const auto& p) { return now >= p.from && now < p.until; });
  const bool alone = draws.loss < conditions_.loss;
  std::uint64_t* const reason = cut     ? &counts_.partitioned
                                : burst ? &counts_.lost_in_bursts
                                : alone ? &counts_.lost
                                        : nullptr;
  if (reason != nullptr) ++*reason;
  return reason == nullptr;
}

/// Returns when its last byte is on the line; nothing: it would wait too long for its first.
std::optional<Time> LinkSimulator::leaves(std::size_t bytes, Time now) {
  if (!(conditions_.bandwidth > 0)) return now;
  const Time begins = std::max(now, line_free_);
  if (to_seconds(begins - now) > conditions_.queue) return {};
  line_free_ = begins + from_seconds(static_cast<double>(bytes) / conditions_.bandwidth);
  return line_free_;
}

void LinkSimulator::put(Time arrival, std::vector<std::byte> datagram) {
  const auto behind = std::lower_bound(in_transit_.begin(), in_transit_.end(), arrival,
                                       [](const InTransit& next, Time t) { return next.arrival > t; });
  in_transit_.insert(behind, {arrival, std::move(datagram)});
}

std::optional<std::vector<std::byte>> LinkSimulator::receive(Time now) {
  if (in_transit_.empty() || in_transit_.back().arrival > now) return {};
  std::vector<std::byte> datagram = std::move(in_transit_.back().datagram);
  in_transit_.pop_back();
  ++counts_.delivered;
  return datagram;
}

std::optional<Time> LinkSimulator::next_arrival() const {
  if (in_transit_.empty()) return {};
  return in_transit_.back().arrival;
}

}  // namespace palpate::protocol
