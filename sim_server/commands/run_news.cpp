#include "sim_server/commands/run_news.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/log.h"

namespace palpate::sim {

RunEvents::RunEvents(const Scene& scene)
    : scene_(scene), held_(scene.tools.size(), false), beyond_(scene.tools.size(), false) {}

void RunEvents::report(NetLink& link, const SimLoop& loop, bool paused) {
  report_paused(paused);
  report_holders(link, paused);
  report_mismatch(link);
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

/// Says that somebody's Hello is of another key; of each kind once a minute, as strangers send what they
/// like.
void RunEvents::report_mismatch(NetLink& link) {
  constexpr int kCallsPerMinute = 600;
  constexpr std::array kTexts{
      "says Hello without a key, and gets no answer: copy the key file of this server there (scp -p), and "
      "give "
      "it with --key FILE",
      "says Hello with another key than this server has, and gets no answer: copy the key file of this "
      "server "
      "there (scp -p)",
      "says Hello with a key, and obeys no answer of this server, which has none: start both with the same "
      "key "
      "(--key FILE), or both without"};
  for (int& calls : unsaid_) calls = std::max(calls - 1, 0);
  NetLink::Mismatch newest;
  if (!link.mismatch.read(newest)) return;
  const auto kind = static_cast<std::size_t>(newest.why);
  if (unsaid_[kind] > 0) return;
  unsaid_[kind] = kCallsPerMinute;
  log::warning("a client at {} {}", protocol::to_string(newest.from), kTexts[kind]);
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

std::string real_time_text(const Json& report) {
  if (report["real_time"].get<bool>()) return "";
  return "no real-time priority: other programs can hold up steps and make the force older, which the age "
         "that "
         "clients report includes; raise `ulimit -r` (rtprio in /etc/security/limits.conf)";
}

}  // namespace palpate::sim
