#include "sim_server/commands/live_view.h"

#include <algorithm>

#include "common/clock.h"
#include "common/error.h"
#include "common/log.h"
#include "protocol/key_file.h"
#include "protocol/udp_socket.h"
#include "sim_server/commands/pictures.h"

namespace palpate::sim {
namespace {

constexpr Time kFieldEach = std::chrono::milliseconds(100);   // at most: it copies all nodes
constexpr Time kPictureEach = std::chrono::milliseconds(15);  // at most

}  // namespace

/// HTTP is not encrypted: what is sent to another machine can be read on its way.
void require_near(const protocol::Endpoint& endpoint, bool insecure, const std::string& risk) {
  if (protocol::is_loopback(endpoint)) return;
  const std::string address = protocol::to_string(endpoint);
  if (insecure)
    return log::warning("--viewer: {} is not this machine, and the page is not encrypted: {}", address, risk);
  fail(
      "--viewer: {} is not this machine, and the page is not encrypted: {}; give the port alone, and on the "
      "other "
      "machine `ssh -L PORT:127.0.0.1:PORT HOST` (--insecure goes without, on a network that you trust)",
      address, risk);
}

std::optional<ViewRequest> view_request(const std::string& viewer, const ListenOptions& listen) {
  const auto address = read_viewer_address(viewer);
  if (!address) return {};
  require_free(*address);
  require_near(
      address->endpoint, listen.insecure,
      "whoever reaches it can look on, and whoever reads along can take the token, and move the tool");
  const auto run = protocol::random_value<protocol::Nonce>();
  return ViewRequest{*address, listen.key ? token_of(protocol::read_keys(*listen.key).back(), run)
                                          : hex_token(protocol::random_value<PageToken>())};
}

LiveView::LiveView(const ViewerAddress& address, std::string token, SceneFacts facts,
                   const Simulation& simulation, Time began)
    : simulation_(simulation),
      facts_(std::move(facts)),
      token_(std::move(token)),
      feed_(facts_.organ.rest, facts_.fields.empty() ? std::span<const Vec3>() : simulation.nodes()),
      viewer_(address, token_, facts_, feed_),
      began_(began) {}

std::string LiveView::link() const {
  return "http://" + protocol::to_string(viewer_.endpoint()) + "/" +
         (token_.empty() ? "" : "#token=" + token_);
}

LoopObserver::Leave LiveView::may_step() noexcept {
  if (!feed_.paused.load(std::memory_order_relaxed)) return {};
  int remaining = feed_.steps.load(std::memory_order_relaxed);
  return {remaining > 0 &&
              feed_.steps.compare_exchange_strong(remaining, remaining - 1, std::memory_order_relaxed),
          true};
}

void LiveView::turned(const LoopTurn& turn) noexcept {
  if (!turn.outcomes.empty()) {
    ++newest_.step;
    newest_.simulated += turn.dt;
    pending_ = true;
  }
  const int pages = feed_.pages.load(std::memory_order_relaxed);
  if (pages == 0) {
    pages_ = 0;
    return;
  }
  note(turn);
  const bool request = feed_.requests_field.load(std::memory_order_relaxed);
  pending_ = pending_ || (request && !wanted_field_);  // while paused, too
  wanted_field_ = request;
  const Time time = now();
  if ((!pending_ && pages == pages_) || time - shown_ < kPictureEach) return;
  pages_ = pages;
  shown_ = time;
  pending_ = false;
  Picture& picture = feed_.pictures.back();
  picture.t = newest_.t;
  picture.step = newest_.step;
  picture.simulated = newest_.simulated;
  picture.step_ms = newest_.step_ms;
  picture.late = newest_.late;
  picture.tools = newest_.tools;
  show_organ(simulation_, picture);
  feed_.pictures.publish();
  if (request && time - field_shown_ >= kFieldEach) {
    field_shown_ = time;
    std::ranges::copy(simulation_.nodes(), feed_.nodes.back().begin());
    feed_.nodes.publish();
  }
  viewer_.ring();
}

/// Notes the outcome of this step, for the picture that shows it.
void LiveView::note(const LoopTurn& turn) noexcept {
  newest_.late = turn.late;
  newest_.t = to_seconds(now() - began_);
  for (std::size_t i = 0; i < turn.inputs.size(); ++i) {
    const SessionInput& input = turn.inputs[i];
    SeenTool& seen = newest_.tools[i];
    const bool was_held = seen.held;
    show_tool(input, turn.outcomes.empty() ? nullptr : &turn.outcomes[i], newest_.t, seen);
    pending_ = pending_ || seen.held != was_held;
  }
  if (!turn.outcomes.empty()) newest_.step_ms = 1e3 * to_seconds(turn.took);
}

Option viewer_option(std::string& address) {
  return {"--viewer",
          "[ADDR:]PORT to serve the live page on (HTTP), or off; without ADDR on this machine alone",
          &address,
          {.shows_default = true}};
}

}  // namespace palpate::sim
