#include "sim_server/serving/captured_steps.h"

#include <array>
#include <map>
#include <optional>
#include <vector>

#include "common/contact/tool.h"
#include "common/log.h"
#include "protocol/capture.h"
#include "protocol/earlier_ticks.h"

namespace palpate::sim {
using namespace protocol;

namespace {

constexpr std::size_t kMostHeld = 100;       // sessions
constexpr std::size_t kStatesStored = 4096;  // of each, the newest: an answer is to one of them

struct HeldSession {
  std::vector<ToolState> states = std::vector<ToolState>(kStatesStored);  // by tick
  std::uint64_t newest_tick = 0, newest_sample = 0, newest_answered = 0;
};

ToolState state_of(const HeldSession& session, const ForceSample& sample) {
  const ToolState& state = session.states[sample.tool_tick % kStatesStored];
  if (state.tick == sample.tool_tick) return state;
  ToolState made{.tool = sample.tool, .tick = sample.tool_tick, .t_ns = sample.tool_t_ns};
  made.p_W = sample.p_W;
  return made;
}

}  // namespace

std::size_t read_captured_steps(const std::filesystem::path& capture,
                                const std::function<void(std::uint64_t, const ToolState&)>& on_state,
                                const std::function<void(const CapturedAnswer&)>& on_answer,
                                const std::function<void(std::uint64_t session)>& on_remaining) {
  CaptureReader reader(capture);
  std::map<std::uint64_t, HeldSession> sessions;
  std::array<bool, kMaxTools> answered{};  // in this step
  std::int64_t step_ns = 0;                // how long it took
  bool paused = false;                     // since then
  CapturedDatagram captured;
  Datagram datagram;
  std::optional<Time> first;
  std::size_t answers = 0;
  while (reader.next(captured)) {
    if (decode(captured.bytes, datagram) != Verdict::kAccepted) continue;
    const std::uint64_t number = datagram.header.session;
    if (sessions.size() >= kMostHeld && !sessions.contains(number)) continue;
    for (const ToolState& state : ticks_of(datagram)) {
      HeldSession& session = sessions[number];
      if (state.tick <= session.newest_tick) continue;
      session.newest_tick = state.tick;
      session.states[state.tick % kStatesStored] = state;
      on_state(number, state);
    }
    if (const auto* sample = std::get_if<ForceSample>(&datagram.message)) {
      HeldSession& session = sessions[number];
      if (sample->number <= session.newest_sample) continue;
      session.newest_sample = sample->number;
      // While it was paused, the same was told again.
      const bool again =
          (sample->flags & ForceSample::kPaused) != 0 && sample->tool_tick == session.newest_answered;
      session.newest_answered = sample->tool_tick;
      paused = paused || again;
      if (again) continue;
      if (!first) first = captured.t;
      // The answers of one step say alike how long it took.
      const bool begins = answers == 0 || answered[sample->tool] || sample->step_ns != step_ns;
      if (begins) answered = {};
      answered[sample->tool] = true;
      step_ns = sample->step_ns;
      on_answer({captured.t - *first, state_of(session, *sample), *sample, number, begins, paused});
      paused = false;
      ++answers;
    } else if (std::holds_alternative<Bye>(datagram.message) && on_remaining) {
      on_remaining(number);
    }
  }
  if (const std::string trouble = reader.trouble(); !trouble.empty())
    log::warning("{}: {}", capture.string(), trouble);
  return answers;
}

}  // namespace palpate::sim
