#pragma once
#include <filesystem>
#include <optional>
#include <vector>

#include "protocol/messages.h"

namespace palpate::sim {

/// The force samples of one session of a capture, in the order of their numbers, with the times of the tool
/// states that they answer.
struct CapturedForces {
  std::vector<protocol::ForceSample> samples;   ///< one or more
  std::uint8_t tool = 0;                        ///< of the server, that the session holds
  double tool_radius = 0.005;                   ///< m: of the session's Welcome, if the capture has it
  std::optional<protocol::ScenePrint> scene{};  ///< of which they are, if its Welcome tells
  double rate_hz() const;                       ///< samples a second; 0 with fewer than two
  double seconds() const;
};

/// Reads those of each session, that with the most first. Throws `Error` where the file cannot be read, or
/// holds no session with two samples or more.
std::vector<CapturedForces> read_captured_forces(const std::filesystem::path& capture);

}  // namespace palpate::sim
