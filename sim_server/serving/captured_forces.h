#pragma once
#include <filesystem>
#include <vector>

#include "protocol/messages.h"
#include "protocol/scene_print.h"

namespace palpate::sim {

/// The force samples of one session of a capture, in the order of their numbers, with the times of the tool
/// states that they answer.
struct CapturedForces {
  std::vector<protocol::ForceSample> samples;
  double tool_radius = 0.005;                   ///< m: of the session's Welcome, if the capture has it
  std::optional<protocol::ScenePrint> scene{};  ///< of a recording in virtual time
  double rate_hz() const;                       ///< samples a second; 0 with fewer than two
  double seconds() const;
};

/// Reads those of the session with the most. Throws `Error` where the file cannot be read, or holds none.
CapturedForces read_captured_forces(const std::filesystem::path& capture);

}  // namespace palpate::sim
