#include "sim_server/commands/run_news.h"

#include "common/log.h"

namespace palpate::sim {

RunEvents::RunEvents(const Scene& scene)
    : scene_(scene), held_(scene.tools.size(), false), beyond_(scene.tools.size(), false) {}

void RunEvents::report(const NetLink& link, const SimLoop& loop, bool paused) {
  report_paused(paused);
  report_holders(link, paused);
  report_beyond(loop);
  report_end(loop);
}

/// Says that a page has paused, or let go on.
void RunEvents::report_paused(bool paused) {
  if (paused != paused_) log::info("{}", paused ? "paused by a page" : "goes on");
  paused_ = paused;
}

/// Says which tools were taken and left since the last look.
void RunEvents::report_holders(const NetLink& link, bool paused) {
  for (std::size_t i = 0; i < held_.size(); ++i) {
    const bool held = link.tools[i].held;
    if (held == held_[i]) continue;
    const std::string tool =
        held_.size() == 1 ? "the tool" : fmt::format("tool {} of {}", i + 1, held_.size());
    log::info("{}", held ? fmt::format("a client took {}{}", tool, paused ? "; a page has paused" : "")
                         : fmt::format("the client is gone; {} is free", tool));
    held_[i] = held;
  }
}

/// Says, once for each tool, that it left what the scene says it stays in.
void RunEvents::report_beyond(const SimLoop& loop) {
  for (std::size_t i = 0; i < beyond_.size(); ++i) {
    if (beyond_[i] || !loop.went_beyond[i]) continue;
    log::warning("{}: tool {} went beyond this, where nothing is built that it could feel; make it wider",
                 scene_.tools[i].reach_where, i + 1);
    beyond_[i] = true;
  }
}

/// Says, once, that a hot tip or a blade is at tissue that cannot be cut.
void RunEvents::report_end(const SimLoop& loop) {
  if (at_end_ || !loop.cut_to_end) return;
  log::warning("{}: a tool cuts at tissue that cannot be cut; a larger region or `within` lets the cut go on",
               scene_.cutting->where);
  at_end_ = true;
}

}  // namespace palpate::sim
