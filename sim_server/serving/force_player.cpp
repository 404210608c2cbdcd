#include "sim_server/serving/force_player.h"

#include "common/clock.h"

namespace palpate::sim {
using protocol::ForceSample;

namespace {
constexpr Time kPollPeriod = std::chrono::milliseconds(1);  // the most that it adds to a latency
}

void ForcePlayer::run(const std::stop_token& stop) noexcept {
  for (Time due = now(); !stop.stop_requested(); sleep_until(due += kPollPeriod)) poll();
}

void ForcePlayer::poll() noexcept {
  mailboxes_.tools[0].input.read(input_);
  if (input_.session != session_) {
    session_ = input_.session;
    if (session_ == 0) return;  // the client is gone
    next_ = 0;
    start_ = now();
    played = 0;
    ended = false;
  }
  if (session_ == 0 || next_ == forces_.samples.size()) return;
  const Time since = now() - start_;
  const auto is_due = [&](std::size_t i) {
    return Time{forces_.samples[i].tool_t_ns - forces_.samples.front().tool_t_ns} <= since;
  };
  if (!is_due(next_)) return;
  while (next_ + 1 < forces_.samples.size() && is_due(next_ + 1)) ++next_;  // the newest, of more than one
  ForceOutput output{session_, forces_.samples[next_++]};
  ForceSample& sample = output.sample;
  const protocol::ToolState& state = input_.state;
  sample.tool = 0;
  sample.number = next_;
  sample.tool_tick = state.tick;
  sample.tool_t_ns = state.t_ns;
  sample.p_W = state.p_W;
  sample.flags &= ForceSample::kInContact | ForceSample::kFlagged;
  mailboxes_.tools[0].force.write(output);
  mailboxes_.bell.ring();
  played = next_;
  ended = next_ == forces_.samples.size();
}

}  // namespace palpate::sim
