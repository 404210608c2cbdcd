#include "haptic_client/evaluation/captured_session.h"

#include <algorithm>
#include <utility>

#include "common/error.h"
#include "protocol/earlier_ticks.h"

namespace palpate::client {
using namespace protocol;

namespace {
constexpr std::size_t kStoredSamples = 2048;  // a minute at 33 Hz, far beyond any delay of a link
}

CaptureSurvey survey(const std::filesystem::path& file, const ReadingProgress& progress) {
  CaptureReader reader(file);
  CaptureSorter sorter;
  CapturedDatagram captured;
  Datagram datagram;
  for (std::uint64_t i = 0; reader.next(captured); ++i) {
    sorter.sort(captured, datagram);
    if (i % 4096 == 0) progress(reader.fraction());
  }
  progress(1);
  if (sorter.runs().empty() && sorter.other_version()) {
    fail("{}: its packets are of protocol version {}, this program knows version {}", file.string(),
         *sorter.other_version(), kProtocolVersion);
  }
  const bool any = std::ranges::any_of(sorter.runs(), [](const CapturedRun& run) { return run.ticks > 0; });
  if (!any) {
    fail(
        "{}: holds no tool states of Palpate, so there is nothing to replay ({} packets, {} of them ours); "
        "was "
        "it captured at the server's UDP port (45130, if you did not choose another)?",
        file.string(), reader.packets(), sorter.ours());
  }
  return {.runs = sorter.runs(),
          .packets = reader.packets(),
          .ours = sorter.ours(),
          .refused = sorter.refused(),
          .omitted = sorter.omitted(),
          .other = reader.packets() - sorter.ours() - sorter.refused(),
          .trouble = reader.trouble()};
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
      if (samples_.size() > kStoredSamples) samples_.pop_front();
    } else if (const auto* page = std::get_if<SurfacePage>(&datagram.message)) {
      pages_.push_back(*page);
    }
    for (const ToolState& state : ticks_of(datagram)) {
      const auto after =
          std::ranges::find_if(waiting_, [&](const Numbered& n) { return n.state.tick < state.tick; });
      waiting_.insert(after, {place_, datagram.header.sequence, state});
    }
  }
}

bool CapturedSession::next(CapturedTick& out) {
  for (fill(); !waiting_.empty(); fill()) {
    const Numbered tick = waiting_.back();
    waiting_.pop_back();
    const Time t{tick.state.t_ns};
    if (out_of_row(t)) {
      ++missing_.backwards;
      continue;
    }
    note_gap(tick);
    newest_t_ = t;
    out = {tick.state, {}, {}};
    hand_over_pages(tick.state, out);
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
  if (!std::exchange(tells_pages_, true)) missing_.undated += pages_.size();
  return false;
}

/// Where two datagrams follow each other, the ticks between them never travelled.
void CapturedSession::note_gap(const Numbered& tick) {
  if (newest_tick_ > 0 && tick.state.tick > newest_tick_ + 1) {
    const bool follows = tick.sequence == sequence_ || tick.sequence == sequence_ + 1;
    (follows ? missing_.left_out : missing_.ticks) += tick.state.tick - newest_tick_ - 1;
  }
  newest_tick_ = tick.state.tick;
  sequence_ = tick.sequence;
}

/// Pages are taken in the order in which they came. A tick that does not request the surface does not tell
/// which it had; those are handed over to the next tick that does.
void CapturedSession::hand_over_pages(const ToolState& state, CapturedTick& out) {
  const bool tells = (state.flags & ToolState::kRequestsSurface) != 0;
  const std::uint64_t taken = state.pages_taken;
  if (tells && !tells_pages_ && taken > pages_taken_) missing_.undated += taken - pages_taken_;
  tells_pages_ = tells || pages_taken_ == 0;
  for (; pages_taken_ < taken && !pages_.empty(); ++pages_taken_) {
    out.pages.push_back(pages_.front());
    pages_.pop_front();
  }
  if (pages_taken_ >= taken) return;
  missing_.pages += taken - pages_taken_;
  pages_taken_ = taken;
}

/// Not after the tick before; or so far ahead that the tick after it lies between the two.
bool CapturedSession::out_of_row(Time t) const {
  if (!sensible(t) || t <= newest_t_) return true;
  if (waiting_.empty()) return false;
  const Time after{waiting_.back().state.t_ns};
  return after > newest_t_ && after <= t;
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
