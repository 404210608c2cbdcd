#pragma once
/// The text messages to a page: MESSAGES.md. No clock, no socket.
#include <limits>
#include <span>
#include <string>

#include "sim_server/viewer/picture.h"

namespace palpate::sim {

/// `may_control`: this page has the token.
std::string scene_text(const SceneFacts& scene, bool may_control);

/// Speed of a session, as measured over the last second; NaN: not known yet.
struct MeasuredRates {
  double steps_hz = std::numeric_limits<double>::quiet_NaN();
  double real_time_factor = std::numeric_limits<double>::quiet_NaN();  ///< s of tissue a second
};
/// `peers`: of each tool of the scene. Loads as they stand in the picture.
std::string state_text(const Picture& picture, std::span<const SeenPeer> peers, const MeasuredRates& rates,
                       bool paused);
std::string client_text(const SeenClient& client);
std::string refused_text(const std::string& why);

}  // namespace palpate::sim
