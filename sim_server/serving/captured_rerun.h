#pragma once
#include <cstdint>
#include <deque>
#include <set>
#include <span>
#include <vector>

#include "sim_server/serving/captured_steps.h"
#include "sim_server/serving/served_tools.h"

namespace palpate::sim {

/// Steps a scene again as the server of a capture did: with the tool states that it answered, along the paths
/// that had arrived by then, and as often in between as it stepped without an answer. A server that steps by
/// the clock says with each answer how long the step took (`step_ns`), so the steps between two answers
/// follow from the times of their states; one in virtual time answers each step. Exact, to the last bit,
/// where the capture has all states and answers of a server that steps at the rate of the scene. One thread.
class CapturedRerun {
 public:
  /// `rate_hz`: of the scene; 0: as fast as it can. The simulation outlives this.
  CapturedRerun(Simulation& simulation, double rate_hz);

  /// Takes a state that came to the server.
  void take(std::uint64_t session, const protocol::ToolState& state);
  /// The tool of this session is in no hand from the step on that the next answer begins.
  void release(std::uint64_t session) { departed_.insert(session); }
  /// Takes an answer for the step to come, after the steps without one before it. Throws `Error` where the
  /// scene has no such tool.
  void take(const CapturedAnswer& answer);
  /// Steps with the answers taken. Returns an outcome for each tool, valid until the next call.
  std::span<const ServedTools::Outcome> step();

  std::span<const SessionInput> inputs() const { return inputs_; }
  double simulated() const { return simulated_; }               ///< s, of all steps
  std::uint64_t steps() const { return steps_; }                ///< those without an answer, too
  double off() const { return off_; }                           ///< of a force from that captured, at most, N
  double largest() const { return largest_; }                   ///< of the captured forces, N
  std::size_t tools_taken() const { return sessions_.size(); }  ///< that the capture has

 private:
  void begin_step(const CapturedAnswer& answer);
  void drop_departed(Time t);
  void follow(std::size_t tool, const CapturedAnswer& answer);

  /// A state that no answer has come after yet.
  struct Arrived {
    std::uint64_t session;
    protocol::ToolState state;
  };
  ServedTools served_;
  double period_;  // s; 0: none
  std::vector<SessionInput> inputs_;
  std::vector<std::deque<Arrived>> arrived_;  // of each tool
  std::vector<Time> answered_;                // by tool: when last, in the capture
  std::vector<Vec3> captured_;
  std::set<std::uint64_t> departed_;  // sessions: an answer that was under way is of its own step alone
  std::set<std::size_t> sessions_;    // tools that have been answered
  std::int64_t last_step_ns_ = 0;     // how long the step before took, ns; 0: in virtual time
  double dt_ = 0, simulated_ = 0, off_ = 0, largest_ = 0;
  std::uint64_t steps_ = 0;
};

}  // namespace palpate::sim
