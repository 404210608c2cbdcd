#pragma once
/// The text messages to a page: MESSAGES.md. No clock, no socket.
#include <span>
#include <string>

#include "sim_server/viewer/picture.h"

namespace palpate::sim {

/// `may_control`: this page has the token.
std::string scene_text(const SceneFacts& scene, bool may_control);

/// How fast a session goes, as measured over the last second.
struct MeasuredRates {
  double steps_hz = 0;
  double real_time_factor = 0;  ///< s of tissue a second; 0 while nothing steps
};
/// `peers`: of each tool of the scene. Loads as they stand in the picture.
std::string state_text(const Picture& picture, std::span<const SeenPeer> peers, const MeasuredRates& rates,
                       bool paused);
std::string client_text(const SeenClient& client);
std::string refused_text(const std::string& why);

}  // namespace palpate::sim
