#include "sim_server/commands/run_news.h"

#include "common/log.h"

namespace palpate::sim {

RunNews::RunNews(const Scene& scene)
    : scene_(scene), held_(scene.tools.size(), false), beyond_(scene.tools.size(), false) {}

void RunNews::tell(const NetLink& link, const SimLoop& loop, bool paused) {
  tell_paused(paused);
  tell_holders(link, paused);
  tell_beyond(loop);
  tell_end(loop);
  if (scene_.cutting && scene_.cutting->growth) tell_growth(loop.growth);
}

/// Says that a page has paused, or let go on.
void RunNews::tell_paused(bool paused) {
  if (paused != paused_) log::info("{}", paused ? "paused by a page" : "goes on");
  paused_ = paused;
}

/// Says which tools were taken and left since the last look.
void RunNews::tell_holders(const NetLink& link, bool paused) {
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
void RunNews::tell_beyond(const SimLoop& loop) {
  for (std::size_t i = 0; i < beyond_.size(); ++i) {
    if (beyond_[i] || !loop.went_beyond[i]) continue;
    log::warning("{}: tool {} went beyond this, where nothing is built that it could feel; make it wider",
                 scene_.tools[i].reach_where, i + 1);
    beyond_[i] = true;
  }
}

/// Says, once, that a hot tip is at tissue that cannot be cut.
void RunNews::tell_end(const SimLoop& loop) {
  if (at_end_ || !loop.cut_to_end) return;
  log::warning("{}: a hot tip is at tissue that cannot be cut; {}", scene_.cutting->where,
               scene_.cutting->growth
                   ? "[cutting.growth] lets a cut go on that comes near its end slowly enough"
                   : "a larger region or `within`, or [cutting.growth], would let the cut go on");
  at_end_ = true;
}

/// Says how what can be cut grows.
void RunNews::tell_growth(const SimLoop::Growth& now) {
  if (const std::size_t times = now.times; times > growth_.times) {
    log::info("{} more tetrahedra can be cut", now.tetrahedra - growth_.tetrahedra);
    growth_.times = times;
    growth_.tetrahedra = now.tetrahedra;
  }
  if (const std::size_t begun = now.begun; begun > growth_.begun) {
    log::info("the cut has come near the end of what can be cut; in {:g} s at the earliest it goes on beyond",
              scene_.cutting->growth->after);
    growth_.begun = begun;
  }
  if (const std::size_t failures = now.failures; failures > growth_.failures) {
    log::warning("{}: what can be cut stays as it is; the report at the end says why",
                 scene_.cutting->growth->where);
    growth_.failures = failures;
  }
  const std::size_t late = now.late_steps;
  const bool waits = growth_.times + growth_.failures < growth_.begun;
  if (late > growth_.late_steps && waits && told_late_ < growth_.begun) {
    log::warning(
        "{}: after {:g} s the larger body is not made yet; until it is, the cut ends where it did "
        "(a larger `after` says so beforehand)",
        scene_.cutting->growth->where, scene_.cutting->growth->after);
    told_late_ = growth_.begun;
  }
  growth_.late_steps = late;
}

}  // namespace palpate::sim
