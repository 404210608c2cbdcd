#include "haptic_client/evaluation/capture_sorter.h"

#include <algorithm>

namespace palpate::client {
using namespace protocol;

namespace {
constexpr std::size_t kMostRuns = 1000;
constexpr std::size_t kVersionByte = 4;
}  // namespace

bool CapturedDirection::accept(std::uint64_t sequence) {
  if (!window.accept(sequence, stats)) return false;
  lowest = lowest == 0 ? sequence : std::min(lowest, sequence);
  return true;
}

void CapturedDirection::begin_session() {
  not_captured += lowest > 0 ? lowest - 1 : 0;
  lowest = 0;
  window = {};
}

std::uint64_t CapturedDirection::lost() const {
  return stats.lost - not_captured - (lowest > 0 ? lowest - 1 : 0);
}

double CapturedRun::ticks_hz() const {
  const double seconds = to_seconds(newest - first);
  return seconds > 0 ? static_cast<double>(newest_tick - first_tick) / seconds : 0;
}

std::optional<std::size_t> CaptureSorter::sort(const CapturedDatagram& captured, Datagram& datagram) {
  const Verdict verdict = decode(captured.bytes, datagram);
  if (verdict == Verdict::kTooShort || verdict == Verdict::kNotOurs) return {};
  if (verdict != Verdict::kAccepted) {
    ++refused_;
    if (verdict == Verdict::kVersion) other_version_ = std::to_integer<int>(captured.bytes[kVersionByte]);
    return {};
  }
  ++ours_;
  const Header& header = datagram.header;
  if (const auto* state = std::get_if<ToolState>(&datagram.message))
    return sort_state(*state, header, captured.from);
  const auto* sample = std::get_if<ForceSample>(&datagram.message);
  if (sample == nullptr) return {};
  CapturedRun* const run = run_of(captured.to, header.session, sample->tool_tick);
  if (run == nullptr || !run->down.accept(header.sequence)) return {};
  ++run->samples;
  return run - runs_.data();
}

std::optional<std::size_t> CaptureSorter::sort_state(const ToolState& state, const Header& header,
                                                     const Endpoint& client) {
  CapturedRun* const found = run_of(client, header.session, state.tick);
  if (found == nullptr || !found->up.accept(header.sequence)) return {};
  CapturedRun& run = *found;
  const std::size_t index = found - runs_.data();
  ++run.ticks;
  const Time t{state.t_ns};
  if (!sensible(t)) return index;
  if (run.newest_tick == 0) {
    run.first_tick = run.newest_tick = state.tick;
    run.first = run.newest = t;
  } else if (state.tick > run.newest_tick && t > run.newest) {
    run.newest_tick = state.tick;
    run.newest = t;
  }
  return index;
}

/// The newest run of this client goes on, unless a new session counts its ticks from the beginning.
CapturedRun* CaptureSorter::run_of(const Endpoint& client, std::uint64_t session, std::uint64_t tick) {
  for (std::size_t i = runs_.size(); i-- > 0;) {
    CapturedRun& run = runs_[i];
    if (run.client != client) continue;
    if (run.session == session) return &run;
    if (tick + kShuffled < run.newest_tick) break;
    run.session = session;
    run.up.begin_session();
    run.down.begin_session();
    return &run;
  }
  if (runs_.size() == kMostRuns) return nullptr;
  runs_.push_back({.client = client, .session = session});
  return &runs_.back();
}

}  // namespace palpate::client
