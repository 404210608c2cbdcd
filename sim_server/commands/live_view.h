#pragma once
#include <optional>
#include <string>

#include "common/program.h"
#include "sim_server/commands/listening.h"
#include "sim_server/serving/sim_loop.h"
#include "sim_server/viewer/viewer.h"

namespace palpate::sim {

/// Address of the page, and the token that ends it for those who may do more than watch.
struct ViewRequest {
  ViewerAddress address;
  std::string token;
};

/// Returns the page settings that `--viewer` requests; nothing for "off". Throws `Error` where that address
/// cannot be had. Also throws where it is not this machine's own and `--insecure` is not set: the token would
/// be sent in clear.
std::optional<ViewRequest> view_request(const std::string& viewer, const ListenOptions& listen);

/// Throws `Error` where a page would be served to other machines, unless that is `insecure` on purpose; then
/// warns. `risk`: what whoever reaches or reads it can do.
void require_near(const protocol::Endpoint& endpoint, bool insecure, const std::string& risk);

/// The live page of a session: copies what a page is shown out of the simulation's thread, while a page is
/// open, and lets who has the token pause it.
class LiveView final : public LoopObserver {
 public:
  /// `began`: time 0 of what is shown. Both references outlive this. Throws `Error` as `Viewer`.
  LiveView(const ViewerAddress& address, std::string token, SceneFacts facts, const Simulation& simulation,
           Time began);

  Leave may_step() noexcept override;
  void turned(const LoopTurn& turn) noexcept override;

  Viewer& viewer() { return viewer_; }
  ViewerFeed& feed() { return feed_; }
  const ViewerFeed& feed() const { return feed_; }
  const SceneFacts& facts() const { return facts_; }
  /// "http://127.0.0.1:8080/#token=...".
  std::string link() const;

 private:
  void note(const LoopTurn& turn) noexcept;

  const Simulation& simulation_;
  SceneFacts facts_;
  std::string token_;
  ViewerFeed feed_;
  Viewer viewer_;
  Time began_, shown_{}, field_shown_{};
  int pages_ = 0;         // when it last looked
  bool pending_ = false;  // a picture of what was stepped
  bool wanted_field_ = false;
  Picture newest_;  // without positions
};

/// `--viewer`.
Option viewer_option(std::string& address);

}  // namespace palpate::sim
