#include "haptic_client/evaluation/capture_sorter.h"

#include <algorithm>

#include "protocol/earlier_ticks.h"
#include "protocol/scene_print.h"

namespace palpate::client {
using namespace protocol;

namespace {

constexpr std::size_t kMost = 1000;  // runs, and sessions of one

template <class Count>
std::uint64_t sum(const std::vector<CapturedLink>& links, Count count) {
  std::uint64_t all = 0;
  for (const CapturedLink& link : links) all += count(link.up) + count(link.down);
  return all;
}

}  // namespace

bool CapturedDirection::accept(std::uint64_t sequence) {
  if (!begun && sequence > 0) window.start_at(sequence);  // a capture may begin in mid-session
  begun = begun || sequence > 0;
  return window.accept(sequence, stats);
}

double CapturedRun::ticks_hz() const {
  const double seconds = to_seconds(newest - first);
  return seconds > 0 ? static_cast<double>(newest_tick - first_tick) / seconds : 0;
}
std::uint64_t CapturedRun::lost() const {
  return sum(links, [](const CapturedDirection& d) { return d.lost(); });
}
std::uint64_t CapturedRun::reordered() const {
  return sum(links, [](const CapturedDirection& d) { return d.stats.reordered; });
}
std::uint64_t CapturedRun::duplicated() const {
  return sum(links, [](const CapturedDirection& d) { return d.stats.duplicated; });
}

std::optional<std::size_t> CaptureSorter::sort(const CapturedDatagram& captured, Datagram& datagram) {
  const Verdict verdict = decode(captured.bytes, datagram);
  if (verdict == Verdict::kTooShort || verdict == Verdict::kNotOurs) return {};
  if (verdict != Verdict::kAccepted) {
    ++refused_;
    if (verdict == Verdict::kVersion) other_version_ = std::to_integer<int>(captured.bytes[kVersionAt]);
    return {};
  }
  ++ours_;
  const Header& header = datagram.header;
  if (std::holds_alternative<ToolState>(datagram.message))
    return sort_states(ticks_of(datagram), header, captured.from);
  if (std::holds_alternative<ForceSample>(datagram.message)) return sort_sample(header, captured.to, true);
  if (std::holds_alternative<SurfacePage>(datagram.message)) return sort_sample(header, captured.to, false);
  if (const auto* welcomed = std::get_if<Welcome>(&datagram.message)) welcome(*welcomed, header, captured.to);
  return {};
}

/// Stands before the first tick of its session; again, in mid-session, it has a number, too. What it says of
/// the scene is taken once: a second one of another scene is forged.
void CaptureSorter::welcome(const Welcome& welcome, const Header& header, const Endpoint& client) {
  if (scenes_.size() < kMost) scenes_.emplace(header.session, print_in(welcome));
  if (const Place place = known(client, header.session); place.link != nullptr)
    place.link->down.accept(header.sequence);
}

CapturedLink& CaptureSorter::add_link(CapturedRun& run, std::uint64_t session) {
  const auto scene = scenes_.find(session);
  run.links.push_back({.session = session, .scene = scene == scenes_.end() ? std::nullopt : scene->second});
  return run.links.back();
}

void CaptureSorter::add_tick(CapturedRun& run, const ToolState& tick) {
  ++run.ticks;
  const Time t{tick.t_ns};
  if (!sensible(t)) return;
  if (run.newest_tick == 0) {
    run.first_tick = run.newest_tick = tick.tick;
    run.first = run.newest = t;
  } else if (tick.tick > run.newest_tick && t > run.newest) {
    run.newest_tick = tick.tick;
    run.newest = t;
  }
}

std::optional<std::size_t> CaptureSorter::sort_states(std::span<const ToolState> ticks, const Header& header,
                                                      const Endpoint& client) {
  const auto [run, link] = place_of(ticks.front(), client, header.session);
  if (link == nullptr) {
    ++omitted_;
    return {};
  }
  if (!link->up.accept(header.sequence)) return {};
  // Before the first tick, of a tool that waits for others to be let in: it says nothing of a place.
  if (ticks.size() == 1 && ticks.front().tick == 1 && (ticks.front().flags & ToolState::kDeviceLost) != 0)
    return {};
  for (const ToolState& tick : ticks) add_tick(*run, tick);
  return run - runs_.data();
}

/// Sorts a message of the server. It tells a session from another, but not a run: it never starts a session
/// where there is a run.
std::optional<std::size_t> CaptureSorter::sort_sample(const Header& header, const Endpoint& client,
                                                      bool is_sample) {
  auto [run, link] = known(client, header.session);
  if (run == nullptr) run = newest_run(client);
  if (run == nullptr) {  // a capture that begins between a tool state and its answer
    run = start_run(client);
    if (run == nullptr) return {};
    link = &add_link(*run, header.session);
  }
  if (link != nullptr && !link->down.accept(header.sequence)) return {};
  run->samples += is_sample ? 1 : 0;
  return run - runs_.data();
}

/// The newest run of this client goes on, unless a new session counts its ticks from the beginning.
CaptureSorter::Place CaptureSorter::place_of(const ToolState& state, const Endpoint& client,
                                             std::uint64_t session) {
  if (const Place place = known(client, session); place.run != nullptr) return place;
  CapturedRun* run = newest_run(client);
  if (run == nullptr || state.tick + kShuffled < run->newest_tick) run = start_run(client);
  if (run == nullptr || run->links.size() == kMost) return {};
  return {run, &add_link(*run, session)};
}

/// The server draws the number of a session: whoever has it goes on with that session, also from another
/// address.
CaptureSorter::Place CaptureSorter::known(const Endpoint& client, std::uint64_t session) {
  for (auto run = runs_.rbegin(); run != runs_.rend(); ++run) {
    for (auto link = run->links.rbegin(); link != run->links.rend(); ++link) {
      if (link->session != session) continue;
      run->client = client;
      return {&*run, &*link};
    }
  }
  return {};
}

CapturedRun* CaptureSorter::newest_run(const Endpoint& client) {
  const auto found = std::find_if(runs_.rbegin(), runs_.rend(),
                                  [&](const CapturedRun& run) { return run.client == client; });
  return found == runs_.rend() ? nullptr : &*found;
}

CapturedRun* CaptureSorter::start_run(const Endpoint& client) {
  if (runs_.size() == kMost) return nullptr;
  runs_.push_back({.client = client});
  return &runs_.back();
}

}  // namespace palpate::client
