#pragma once
#include <filesystem>
#include <functional>

#include "common/time.h"
#include "protocol/messages.h"

namespace palpate::sim {

/// Answer of a server in a captured session, with its tool state.
struct CapturedAnswer {
  Time t{};                   ///< when it was captured, from the first of them
  protocol::ToolState state;  ///< as captured; where the capture lacks it, the place of the answer alone
  protocol::ForceSample sample;
  std::uint64_t session = 0;  ///< of the client
  bool begins_step = false;   ///< those that follow, of other tools, were computed in the same step
  bool after_pause = false;   ///< the server was paused since the step before
};

/// Reads a capture from its beginning: each tool state that came, in order, with its session, each answer,
/// once, and each session whose client or server said that it leaves; what both ends or two interfaces
/// captured counts once. Returns how many answers there were. Throws `Error` where the file cannot be read;
/// warns where it ends amid a datagram.
std::size_t read_captured_steps(
    const std::filesystem::path& capture,
    const std::function<void(std::uint64_t, const protocol::ToolState&)>& on_state,
    const std::function<void(const CapturedAnswer&)>& on_answer,
    const std::function<void(std::uint64_t session)>& on_remaining = {});

}  // namespace palpate::sim
