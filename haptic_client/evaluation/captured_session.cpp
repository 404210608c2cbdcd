#include "haptic_client/evaluation/captured_session.h"

#include <algorithm>

#include "common/error.h"

namespace palpate::client {
using namespace protocol;

namespace {

constexpr std::size_t kMostRuns = 1000;
constexpr std::size_t kShuffled = 64;  // ticks: how far out of order they may stand
constexpr std::size_t kKeptSamples = 2048;
constexpr Time kLatest{Time::rep{1} << 61};
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
  if (t < Time::zero() || t > kLatest) return index;
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

CaptureSurvey survey(const std::filesystem::path& file, const ReadingProgress& progress) {
  CaptureReader reader(file);
  CaptureSorter sorter;
  CapturedDatagram captured;
  Datagram datagram;
  for (std::uint64_t i = 0; reader.next(captured); ++i) {
    sorter.sort(captured, datagram);
    if (i % 4096 == 0) progress(reader.share());
  }
  progress(1);
  if (sorter.runs().empty() && sorter.other_version()) {
    fail("{}: its packets are of protocol version {}, this program knows version {}", file.string(),
         *sorter.other_version(), kProtocolVersion);
  }
  const bool any = std::any_of(sorter.runs().begin(), sorter.runs().end(),
                               [](const CapturedRun& run) { return run.ticks > 0; });
  if (!any) {
    fail(
        "{}: holds no tool states of Palpate, so there is nothing to replay ({} packets, {} of them ours); "
        "was "
        "it captured at the server's UDP port (45130, if you did not choose another)?",
        file.string(), reader.packets(), sorter.ours());
  }
  return {sorter.runs(),
          reader.packets(),
          sorter.ours(),
          sorter.refused(),
          reader.packets() - sorter.ours() - sorter.refused(),
          reader.trouble()};
}

CapturedSession::CapturedSession(const std::filesystem::path& file, std::size_t run)
    : reader_(file), run_(run) {}

/// Reads until more ticks wait than may stand out of order, or the file ends.
void CapturedSession::fill() {
  CapturedDatagram captured;
  Datagram datagram;
  while (!ended_ && waiting_.size() <= kShuffled) {
    if (!reader_.next(captured)) {
      ended_ = true;
      return;
    }
    ++place_;
    if (sorter_.sort(captured, datagram) != run_) continue;
    if (const auto* sample = std::get_if<ForceSample>(&datagram.message)) {
      samples_.push_back({place_, *sample});
      if (samples_.size() > kKeptSamples) samples_.pop_front();
    } else if (const auto* state = std::get_if<ToolState>(&datagram.message)) {
      const auto after = std::find_if(waiting_.begin(), waiting_.end(),
                                      [&](const Numbered& n) { return n.state.tick < state->tick; });
      waiting_.insert(after, {place_, *state});
    }
  }
}

bool CapturedSession::next(CapturedTick& out) {
  for (fill(); !waiting_.empty(); fill()) {
    const Numbered tick = waiting_.back();
    waiting_.pop_back();
    const Time t{tick.state.t_ns};
    if (t <= newest_t_ || t > kLatest) {
      ++missing_.backwards;
      continue;
    }
    if (newest_tick_ > 0 && tick.state.tick > newest_tick_ + 1)
      missing_.ticks += tick.state.tick - newest_tick_ - 1;
    newest_tick_ = tick.state.tick;
    newest_t_ = t;
    out = {tick.state, {}};
    if (tick.state.newest_sample == newest_sample_) return true;
    newest_sample_ = tick.state.newest_sample;
    const ForceSample* const sample = find_sample(newest_sample_, tick.place);
    if (sample != nullptr) {
      out.arrived = *sample;
    } else {
      ++missing_.samples;
    }
    return true;
  }
  return false;
}

/// Numbers start again with a new session: the newest before `place` in the file is meant. Where the
/// capturing machine is not the client, or there was no latency, it may also stand a little behind.
const ForceSample* CapturedSession::find_sample(std::uint64_t number, std::uint64_t place) const {
  const ForceSample* behind = nullptr;
  for (auto it = samples_.rbegin(); it != samples_.rend(); ++it) {
    if (it->sample.number != number) continue;
    if (it->place < place) return &it->sample;
    behind = &it->sample;
  }
  return behind;
}

}  // namespace palpate::client
