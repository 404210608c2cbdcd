#include "protocol/link_watcher.h"

#include <fmt/core.h>

#include "common/log.h"

namespace palpate::protocol {

std::string published_since(const LinkStats& before, const LinkStats& now) {
  std::string text =
      fmt::format("{} sent, {} received", now.sent - before.sent, now.received - before.received);
  const auto add = [&](const char* what, std::uint64_t earlier, std::uint64_t later) {
    // A late datagram takes one from those lost.
    if (later != earlier) text += fmt::format(", {} {}", static_cast<std::int64_t>(later - earlier), what);
  };
  add("lost", before.lost, now.lost);
  add("of them values", before.values_lost, now.values_lost);
  add("reordered", before.reordered, now.reordered);
  add("overtaken", before.overtaken, now.overtaken);
  add("duplicated", before.duplicated, now.duplicated);
  add("implausible", before.implausible, now.implausible);
  add("times begun anew", before.began_anew, now.began_anew);
  for (std::size_t i = 0; i < now.rejected_by.size(); ++i)
    add(fmt::format("rejected ({})", name_of(static_cast<Verdict>(i))).c_str(), before.rejected_by[i],
        now.rejected_by[i]);
  return text;
}

void LinkWatcher::poll(const std::string& name) {
  if (++polls_ < kPollsPerClock) return;
  polls_ = 0;
  newest_.read(now_);
  if (!log::is_debugging()) return;
  log::debug("{}link, in the last second: {}", name, published_since(before_, now_));
  before_ = now_;
}

}  // namespace palpate::protocol
