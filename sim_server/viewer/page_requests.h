#pragma once
#include <string>

#include "sim_server/viewer/feed.h"
#include "sim_server/viewer/page_link.h"

namespace palpate::sim {

/// Obeys the messages of pages. No clock, no socket; the page's thread.
struct PageRequests {
  std::string token;  ///< who has it may pause, point and choose; empty: nobody
  const SceneFacts& scene;
  ViewerFeed& feed;

  /// Does what a page requests, or has its link say why not. False if the message may not be said now: hello
  /// comes first, and once.
  bool obey(PageLink& link, const PageMessage& message);

 private:
  void control(PageLink& link, const PageMessage& message);
};

}  // namespace palpate::sim
