#pragma once
#include <optional>

#include "protocol/messages.h"
#include "sim_server/simulation.h"

namespace palpate::sim {

/// The newest pose of a tool, and in whose session; session 0: nobody holds it.
struct ToolInput {
  std::uint64_t session = 0;
  protocol::ToolState state;
};

/// The simulation as a client meets it: a pose in, an answer out. No clock, thread or socket, so it runs the
/// same in the loop and in virtual time. One thread; no allocation.
class ServedTool {
 public:
  explicit ServedTool(Simulation& simulation) : simulation_(simulation) {}

  struct Outcome {
    ToolForce force;
    std::optional<protocol::ForceSample> answer;  ///< to a fresh pose only; the caller knows `step_ns`
  };

  /// One step of `dt` (s). `fresh`: `input` came since the last step; an old pose deserves no new answer, as
  /// the client must see its age. Nothing happens while nobody holds the tool.
  std::optional<Outcome> step(const ToolInput& input, bool fresh, double dt) noexcept;

 private:
  Simulation& simulation_;
  std::uint64_t session_ = 0, samples_ = 0;
};

}  // namespace palpate::sim
