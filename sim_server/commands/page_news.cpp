#include "sim_server/commands/page_news.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>

#include "protocol/udp_socket.h"

namespace palpate::sim {
namespace {

constexpr Time kCountedOver = std::chrono::seconds(2);
constexpr Time kClientEach = std::chrono::milliseconds(90);  // texts of a client; its ticks go all
constexpr double kForgets = 2e4;                             // ns a message: the two clocks drift apart
constexpr double kOtherClock = 1e9;                          // ns: farther off it was set anew

SeenClient::Name name_of(const protocol::Telemetry::Name& told) {
  static_assert(std::tuple_size_v<SeenClient::Name> == protocol::Telemetry::kNameBytes);
  SeenClient::Name name{};
  std::copy(told.begin(), told.end() - 1, name.begin());
  return name;
}

/// What is known of the client of one tool, and of the link to it.
class ToolNews {
 public:
  ToolNews() { client_.errors_percent.fill(std::nanf("")); }
  void take(const protocol::Telemetry& told, Time now, Time began, ViewerFeed& feed);
  void count(const PeerCounts& counts, Time now, SeenPeer& seen);

 private:
  void note_interventions(const protocol::Telemetry& told);
  void note_states(std::uint16_t flags);
  void note_ticks(const protocol::Telemetry& told, double t, ViewerFeed& feed) const;

  struct Mark {
    Time t;
    std::uint64_t received, lost;
  };
  std::deque<Mark> marks_;
  SeenClient client_;
  std::optional<double> clock_;  // ns from the client's clock to ours: the least that was seen lately
  Time shown_{};
};

void ToolNews::take(const protocol::Telemetry& told, Time now, Time began, ViewerFeed& feed) {
  const auto told_at = static_cast<double>(told.t_ns);  // any, off the wire
  const double apart = static_cast<double>(now.count()) - told_at;
  if (!clock_ || std::abs(apart - *clock_) > kOtherClock) clock_ = apart;
  clock_ = std::min(*clock_ + kForgets, apart);
  note_ticks(told, 1e-9 * (told_at + *clock_ - static_cast<double>(began.count())), feed);
  client_.tool = told.tool;
  client_.law = name_of(told.felt_law);
  client_.laws = std::min<std::uint8_t>(told.laws, protocol::Telemetry::kMostLaws);
  if (told.named < client_.laws) {
    client_.law_names[told.named] = name_of(told.name);
    client_.errors_percent[told.named] = told.error_percent < 0 ? std::nanf("") : told.error_percent;
  }
  client_.age_ms = 1e-6 * static_cast<double>(told.age_ns);
  client_.period_ms = 1e-6 * told.period_ns;
  client_.missed = told.missed;
  client_.passivity_gain = static_cast<double>(told.passivity_gain);
  client_.felt_W = told.f_W;
  client_.p_W = told.p_W;
  client_.device = name_of(told.device);
  client_.has_motors = (told.flags & protocol::Telemetry::kHasMotors) != 0;
  note_interventions(told);
  note_states(told.flags);
  if (now - shown_ < kClientEach) return;
  shown_ = now;
  feed.clients[told.tool] = client_;
  ++feed.client_news[told.tool];
}

void ToolNews::note_interventions(const protocol::Telemetry& told) {
  using Name = SeenClient::Name;
  client_.interventions = 0;
  for (const auto& [name, count] : {std::pair{Name{"faded"}, std::uint64_t{told.faded}},
                                    {Name{"clamped"}, std::uint64_t{told.clamped}},
                                    {Name{"slewed"}, std::uint64_t{told.slewed}},
                                    {Name{"damped"}, std::uint64_t{told.damped}}}) {
    client_.intervention_names[client_.interventions] = name;
    client_.intervention_counts[client_.interventions++] = count;
  }
}

void ToolNews::note_states(std::uint16_t flags) {
  using Name = SeenClient::Name;
  using protocol::Telemetry;
  client_.states = 0;
  for (const auto& [flag, name] : {std::pair{Telemetry::kFault, Name{"fault"}},
                                   {Telemetry::kClutched, Name{"clutched"}},
                                   {Telemetry::kDeviceLost, Name{"device_lost"}},
                                   {Telemetry::kFading, Name{"fading"}},
                                   {Telemetry::kPaused, Name{"paused"}}}) {
    if ((flags & flag) != 0) client_.state_names[client_.states++] = name;
  }
}

void ToolNews::note_ticks(const protocol::Telemetry& told, double t, ViewerFeed& feed) const {
  const double dt = 1e-9 * told.dt_ns;
  ClientTicks ticks{.tool = told.tool,
                    .laws = std::min<std::uint8_t>(told.laws, protocol::Telemetry::kMostLaws),
                    .count = std::min<std::uint32_t>(told.count, protocol::Telemetry::kMostTicks),
                    .t = 0,
                    .dt = static_cast<float>(dt)};
  if (ticks.count == 0) return;
  ticks.t = t - dt * (ticks.count - 1);
  for (std::size_t k = 0; k < ticks.count; ++k) {
    ticks.felt[k] = told.felt[k];
    std::copy_n(told.by_law.begin() + static_cast<std::ptrdiff_t>(k * ticks.laws), ticks.laws,
                ticks.by_law[k].begin());
  }
  feed.ticks.push_back(ticks);
}

/// Loss and rate over the last seconds; a session that began anew begins anew here.
void ToolNews::count(const PeerCounts& counts, Time now, SeenPeer& seen) {
  if (!counts.held || (!marks_.empty() && counts.received < marks_.back().received)) marks_.clear();
  if (!counts.held) {
    seen = {};
    *this = {};  // whoever holds it next is another client
    return;
  }
  marks_.push_back({now, counts.received, counts.lost});
  while (marks_.size() > 2 && now - marks_.front().t > kCountedOver) marks_.pop_front();
  const std::string address = protocol::to_string(counts.endpoint);
  seen.held = true;
  seen.address = {};
  std::copy_n(address.begin(), std::min(address.size(), seen.address.size() - 1), seen.address.begin());
  const double received = static_cast<double>(counts.received - marks_.front().received);
  const double lost = static_cast<double>(static_cast<std::int64_t>(counts.lost - marks_.front().lost));
  const double seconds = to_seconds(now - marks_.front().t);
  seen.rate_hz = seconds > 0 ? received / seconds : 0;
  seen.loss_percent = received + lost > 0 ? std::clamp(100 * lost / (received + lost), 0.0, 100.0) : 0;
}

}  // namespace

ViewerFeed::Hooks page_hooks(ViewerFeed& feed, std::size_t tools, PageMailboxes& mailboxes, Doorbell& bell,
                             Time began) {
  auto news = std::make_shared<std::vector<ToolNews>>(tools);
  auto pointers = std::make_shared<std::array<std::uint64_t, kMaxTools>>();
  ViewerFeed::Hooks hooks;
  hooks.news = [&feed, &mailboxes, news, began](Time now) {
    mailboxes.wants_telemetry = feed.pages > 0;
    for (std::size_t i = 0; i < news->size(); ++i) {
      ToolPageMailboxes& tool = mailboxes.tools[i];
      protocol::Telemetry told;
      while (tool.telemetry.pop(told)) (*news)[i].take(told, now, began, feed);
      PeerCounts counts;
      if (tool.peer.read(counts)) (*news)[i].count(counts, now, feed.peers[i]);
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
