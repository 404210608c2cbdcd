#include "sim_server/commands/page_news.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>

#include "protocol/udp_socket.h"

namespace palpate::sim {
namespace {

constexpr Time kCountedOver = std::chrono::seconds(2);       // at 100 Hz one lost state is 0.5 %
constexpr Time kClientEach = std::chrono::milliseconds(90);  // texts of a client; its ticks go all
constexpr double kForgets = 2e4;                             // ns a message: the two clocks drift apart
constexpr double kOtherClock = 1e9;                          // ns: farther off it was set anew

SeenClient::Name name_of(const protocol::Telemetry::Name& published) {
  static_assert(std::tuple_size_v<SeenClient::Name> == protocol::Telemetry::kNameBytes);
  SeenClient::Name name{};
  std::copy(published.begin(), published.end() - 1, name.begin());
  return name;
}

/// The client of one tool, and the link to it, as far as they are known.
class ToolEvents {
 public:
  ToolEvents() { client_.errors_percent.fill(std::nanf("")); }
  void take(const protocol::Telemetry& published, Time now, Time began, ViewerFeed& feed);
  void count(const PeerCounts& counts, Time now, SeenPeer& seen);

 private:
  void note_interventions(const protocol::Telemetry& published);
  void note_states(std::uint16_t flags);
  void note_ticks(const protocol::Telemetry& published, double t, ViewerFeed& feed) const;

  struct Mark {
    Time t;
    std::uint64_t received, lost, ticks;
  };
  std::deque<Mark> marks_;
  SeenClient client_;
  std::optional<double> clock_;  // ns from the client's clock to ours: the least that was seen lately
  Time shown_{};
};

void ToolEvents::take(const protocol::Telemetry& published, Time now, Time began, ViewerFeed& feed) {
  const auto published_at = static_cast<double>(published.t_ns);  // any, off the wire
  const double interval = static_cast<double>(now.count()) - published_at;
  if (!clock_ || std::abs(interval - *clock_) > kOtherClock) clock_ = interval;
  clock_ = std::min(*clock_ + kForgets, interval);
  note_ticks(published, 1e-9 * (published_at + *clock_ - static_cast<double>(began.count())), feed);
  client_.tool = published.tool;
  client_.law = name_of(published.rendered_law);
  client_.laws = std::min<std::uint8_t>(published.laws, protocol::Telemetry::kMostLaws);
  if (published.named < client_.laws) {
    client_.law_names[published.named] = name_of(published.name);
    client_.errors_percent[published.named] =
        published.error_percent < 0 ? std::nanf("") : published.error_percent;
  } else if (const std::size_t part = published.named - client_.laws; part < SeenClient::kMostParts) {
    client_.part_names[part] = name_of(published.name);
    client_.parts_percent[part] = published.error_percent < 0 ? std::nanf("") : published.error_percent;
  }
  client_.age_ms = 1e-6 * static_cast<double>(published.age_ns);
  client_.period_ms = 1e-6 * published.loop.period_ns;
  client_.missed = published.loop.missed;
  client_.passivity_gain = static_cast<double>(published.passivity_gain);
  client_.rendered_W = published.f_W;
  client_.p_W = published.p_W;
  client_.device = name_of(published.device);
  client_.has_motors = (published.flags & protocol::Telemetry::kHasMotors) != 0;
  note_interventions(published);
  note_states(published.flags);
  if (now - shown_ < kClientEach) return;
  shown_ = now;
  feed.clients[published.tool] = client_;
  ++feed.client_events[published.tool];
}

void ToolEvents::note_interventions(const protocol::Telemetry& published) {
  using Name = SeenClient::Name;
  client_.interventions = 0;
  for (const auto& [name, count] : {std::pair{Name{"faded"}, std::uint64_t{published.interventions.faded}},
                                    {Name{"clamped"}, std::uint64_t{published.interventions.clamped}},
                                    {Name{"slewed"}, std::uint64_t{published.interventions.slewed}},
                                    {Name{"damped"}, std::uint64_t{published.interventions.damped}}}) {
    client_.intervention_names[client_.interventions] = name;
    client_.intervention_counts[client_.interventions++] = count;
  }
}

void ToolEvents::note_states(std::uint16_t flags) {
  using Name = SeenClient::Name;
  using protocol::Telemetry;
  client_.states = 0;
  for (const auto& [flag, name] : {std::pair{Telemetry::kFault, Name{"fault"}},
                                   {Telemetry::kClutched, Name{"clutched"}},
                                   {Telemetry::kDeviceLost, Name{"device_lost"}},
                                   {Telemetry::kFading, Name{"fading"}},
                                   {Telemetry::kPaused, Name{"paused"}},
                                   {Telemetry::kUnsettled, Name{"unsettled"}}}) {
    if ((flags & flag) != 0) client_.state_names[client_.states++] = name;
  }
}

void ToolEvents::note_ticks(const protocol::Telemetry& published, double t, ViewerFeed& feed) const {
  const double dt = 1e-9 * published.dt_ns;
  ClientTicks ticks{.tool = published.tool,
                    .laws = std::min<std::uint8_t>(published.laws, protocol::Telemetry::kMostLaws),
                    .count = std::min<std::uint32_t>(published.count, protocol::Telemetry::kMostTicks),
                    .t = 0,
                    .dt = static_cast<float>(dt)};
  if (ticks.count == 0) return;
  ticks.t = t - dt * (ticks.count - 1);
  for (std::size_t k = 0; k < ticks.count; ++k) {
    ticks.rendered[k] = published.rendered[k];
    std::copy_n(published.by_law.begin() + static_cast<std::ptrdiff_t>(k * ticks.laws), ticks.laws,
                ticks.by_law[k].begin());
  }
  feed.ticks.push_back(ticks);
}

/// Loss and rate over the last seconds; a session that began anew begins anew here.
void ToolEvents::count(const PeerCounts& counts, Time now, SeenPeer& seen) {
  if (!counts.held || (!marks_.empty() && counts.received < marks_.back().received)) marks_.clear();
  if (!counts.held) {
    seen = {};
    *this = {};  // whoever holds it next is another client
    return;
  }
  marks_.push_back({now, counts.received, counts.lost, counts.ticks});
  while (marks_.size() > 2 && now - marks_.front().t > kCountedOver) marks_.pop_front();
  const std::string address = protocol::to_string(counts.endpoint);
  seen.held = true;
  seen.address = {};
  std::copy_n(address.begin(), std::min(address.size(), seen.address.size() - 1), seen.address.begin());
  const double received = static_cast<double>(counts.received - marks_.front().received);
  const double lost = static_cast<double>(static_cast<std::int64_t>(counts.lost - marks_.front().lost));
  const double seconds = to_seconds(now - marks_.front().t);
  const auto ticks = static_cast<double>(counts.ticks - marks_.front().ticks);
  seen.rate_hz = seconds > 0 ? ticks / seconds : 0;
  seen.loss_percent = received + lost > 0 ? std::clamp(100 * lost / (received + lost), 0.0, 100.0) : 0;
}

}  // namespace

ViewerFeed::Hooks page_hooks(ViewerFeed& feed, std::size_t tools, PageMailboxes& mailboxes, Doorbell& bell,
                             Time began) {
  auto events = std::make_shared<std::vector<ToolEvents>>(tools);
  auto pointers = std::make_shared<std::array<std::uint64_t, kMaxTools>>();
  ViewerFeed::Hooks hooks;
  hooks.events = [&feed, &mailboxes, events, began](Time now) {
    mailboxes.requests_telemetry = feed.pages > 0;
    for (std::size_t i = 0; i < events->size(); ++i) {
      ToolPageMailboxes& tool = mailboxes.tools[i];
      protocol::Telemetry published;
      while (tool.telemetry.pop(published)) (*events)[i].take(published, now, began, feed);
      PeerCounts counts;
      if (tool.peer.read(counts)) (*events)[i].count(counts, now, feed.peers[i]);
    }
  };
  // Pages count each for itself; a client wants numbers that rise.
  hooks.point = [&mailboxes, &bell, pointers](const PagePointer& said) {
    protocol::Pointer pointer{.tool = said.tool};
    pointer.number = ++(*pointers)[said.tool];
    pointer.p_W = said.p_W;
    pointer.buttons = said.buttons;
    mailboxes.tools[said.tool].pointer.write(pointer);
    bell.ring();
  };
  return hooks;
}

}  // namespace palpate::sim
