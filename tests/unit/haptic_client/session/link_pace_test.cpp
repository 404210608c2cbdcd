#include "haptic_client/session/link_pace.h"

#include <cmath>
#include <random>
#include <vector>

#include "common/ages.h"
#include "haptic_client/pipeline/page_pace.h"
#include "protocol/earlier_ticks.h"
#include "protocol/link_simulator.h"
#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;
using namespace palpate::protocol;
using namespace std::chrono_literals;

namespace {

struct PacedSession {
  Time oldest{};            // sample, once the first second is over
  std::uint64_t faded = 0;  // ticks after it whose newest sample is older than `kOutage`
  std::uint64_t samples = 0, ticks = 0, ticks_heard = 0;
  std::uint64_t pages = 0;  // that came
  LinkLevel level{};
  std::array<Time, kLinkLevels> spent{};
};

/// Pages that a hand lacks from `at` on: contact has come to a new place.
struct Lacking {
  Time at{};
  std::uint32_t pages = 0;
};

/// A hand at 500 Hz and a server of 30 steps a second, in virtual time, over a link each way.
class PacedPair {
 public:
  PacedPair(const LinkConditions& up, const LinkConditions& down, std::vector<Lacking> lacking = {})
      : up_(up, 1), down_(down, 2), lacking_(std::move(lacking)) {}

  PacedSession run(Time span) {
    for (Time t = 10s; t < 10s + span; t += 2ms) {
      take_samples(t);
      tick(t);
      serve(t);
    }
    session_.level = pace_.level();
    session_.spent = pace_.spent();
    return session_;
  }

 private:
  void tick(Time t) {
    ToolState state{.tick = ++session_.ticks, .newest_sample = newest_.number, .t_ns = t.count()};
    const double s = to_seconds(t);
    state.p_W = {0.01 * std::sin(3 * s), 0.02 * std::cos(2 * s), 0.005 * std::sin(7 * s)};
    state.v_W = {0.03 * std::cos(3 * s), -0.04 * std::sin(2 * s), 0.035 * std::cos(7 * s)};
    state.flags = ToolState::kRequestsTangent | ToolState::kRequestsAhead | ToolState::kRequestsErrors;
    if (t > 11s && newest_.number > 0) {
      const Time age = t - Time{newest_.tool_t_ns};
      session_.oldest = std::max(session_.oldest, age);
      session_.faded += age > kOutage ? 1 : 0;
    }
    ask_pages(state, t);
    pace_.shrink(state);
    if (!pace_.packs_ticks()) waiting_.clear();
    waiting_.push_back(state);
    if (!pace_.is_due(t, 30)) return;
    std::array<std::byte, kMaxDatagram> bytes{};
    const std::size_t size = encode_ticks({.session = 9, .sequence = ++sent_}, waiting_, bytes);
    REQUIRE(size > 0);
    up_.send({bytes.data(), size}, t);
    waiting_.clear();
  }
  /// As the pipeline does: a page is asked for again once the patience for it is over.
  void ask_pages(ToolState& state, Time t) {
    for (const Lacking& more : lacking_) {
      if (t == more.at) pages_.resize(pages_.size() + more.pages);
    }
    if (t.count() % 8'000'000 != 0) return;
    page_pace_.bound(pace_.pages_hz());
    const std::size_t room = std::min(page_pace_.allowed(t), state.pages.size());
    std::size_t asked = 0;
    state.pages.fill(ToolState::kNoPage);
    for (std::size_t i = 0; i < pages_.size() && asked < room; ++i) {
      AskedPage& page = pages_[i];
      if (page.came || (page.asked > Time{} && t - page.asked < page_pace_.patience())) continue;
      page.again = page.asked > Time{};
      page_pace_.lost(page.again ? 1 : 0);
      page.asked = t;
      state.pages[asked++] = static_cast<std::uint32_t>(i);
    }
    page_pace_.requested(asked);
    if (asked > 0) state.flags |= ToolState::kAsksPages;
  }
  void serve_pages(const ToolState& state, Time t) {
    if ((state.flags & ToolState::kAsksPages) == 0) return;
    for (const std::uint32_t page : state.pages) {
      if (page == ToolState::kNoPage) continue;
      std::array<std::byte, kMaxDatagram> bytes{};
      const std::size_t size =
          encode({.session = 9, .sequence = ++pages_sent_}, SurfacePage{.page = page}, bytes);
      down_.send({bytes.data(), size}, t);
    }
  }
  void take_page(const SurfacePage& arrived, Time t) {
    AskedPage& page = pages_.at(arrived.page);
    session_.pages += page.came ? 0 : 1;
    page.came = true;
    if (!page.again) page_pace_.came(t - page.asked);
  }
  void serve(Time t) {
    while (const auto bytes = up_.receive(t)) {
      Datagram datagram;
      REQUIRE(decode(*bytes, datagram) == Verdict::kAccepted);
      const auto ticks = ticks_of(datagram);
      session_.ticks_heard += ticks.size();
      for (const ToolState& state : ticks) serve_pages(state, t);
      came_ += 1;
      highest_ = std::max(highest_, datagram.header.sequence);
      if (ticks.back().tick > answered_) heard_ = ticks.back();
    }
    if (t < next_step_) return;
    next_step_ = std::max(next_step_ + 33'333us, t);
    if (heard_.tick <= answered_) return;
    answered_ = heard_.tick;
    ForceSample sample{.number = ++numbers_, .tool_tick = heard_.tick, .tool_t_ns = heard_.t_ns};
    if ((heard_.flags & ToolState::kRequestsTangent) != 0) sample.flags |= ForceSample::kHasTangent;
    if ((heard_.flags & ToolState::kRequestsAhead) != 0) sample.flags |= ForceSample::kHasAhead;
    if ((heard_.flags & ToolState::kRequestsErrors) != 0) sample.flags |= ForceSample::kHasErrors;
    sample.flags |= ForceSample::kHasUplink;
    sample.uplink = {static_cast<std::uint32_t>(came_), static_cast<std::uint32_t>(highest_ - came_)};
    std::array<std::byte, kMaxDatagram> bytes{};
    down_.send({bytes.data(), encode({.session = 9, .sequence = numbers_}, sample, bytes)}, t);
  }
  void take_samples(Time t) {
    while (const auto bytes = down_.receive(t)) {
      Datagram datagram;
      REQUIRE(decode(*bytes, datagram) == Verdict::kAccepted);
      if (const auto* page = std::get_if<SurfacePage>(&datagram.message)) {
        take_page(*page, t);
        continue;
      }
      const auto& sample = std::get<ForceSample>(datagram.message);
      if (sample.number <= newest_.number) continue;
      newest_ = sample;
      ++session_.samples;
      pace_.sample(sample, t - Time{sample.tool_t_ns}, t);
      page_pace_.heard(t - Time{sample.tool_t_ns}, 0s, t);
    }
  }

  struct AskedPage {
    Time asked{};
    bool again = false, came = false;
  };

  LinkSimulator up_, down_;
  LinkPace pace_;
  std::vector<Lacking> lacking_;
  std::vector<AskedPage> pages_;
  PagePace page_pace_;
  std::uint64_t pages_sent_ = 0;
  std::vector<ToolState> waiting_;
  ForceSample newest_;
  ToolState heard_;
  Time next_step_ = 10s;
  std::uint64_t sent_ = 0, came_ = 0, highest_ = 0, answered_ = 0, numbers_ = 0;
  PacedSession session_;
};

/// Of a line of so many kbit/s each way.
PacedSession paced(double kbit_s, Time span = 60s) {
  const LinkConditions line{.delay = 0.01, .bandwidth = 1e3 * kbit_s / 8};
  return PacedPair(line, line).run(span);
}

/// Down a quick link without a limit of bandwidth, that holds all back for the last `length` of each `every`,
/// loses some 30 % of it, drawn, and gives the others at once.
LinkConditions stalled(Time every, Time length, Time span) {
  constexpr Time kPart = 2ms;
  std::mt19937_64 random(1);
  LinkConditions link{.delay_steps = {{Time{}, 0.02}}};
  for (Time end = 10s + every; end < 10s + span; end += every) {
    for (Time t = end - length; t < end; t += kPart) {
      link.delay_steps.push_back({t, to_seconds(end - t)});
      if (random() % 10 < 3) link.partitions.push_back({t, t + kPart});
    }
    link.delay_steps.push_back({end, 0.02});
  }
  return link;
}

Time spent(const PacedSession& session, LinkLevel level) {
  return session.spent[static_cast<std::size_t>(level)];
}

}  // namespace

TEST_CASE("link pace: a good link carries each tick in a datagram of its own from the second second on") {
  for (const double delay : {0.001, 0.15}) {
    const PacedSession session =
        PacedPair({.delay = delay, .jitter = 0.01, .loss = 0.05}, {.delay = delay, .jitter = 0.01}).run(30s);
    CHECK(session.level == LinkLevel::kFull);
    CHECK(to_seconds(spent(session, LinkLevel::kFull)) > 28);
  }
}

TEST_CASE("link pace: no force fades at 512 and at 256 kbit/s, and every tick arrives but those of a trial") {
  for (const double kbit_s : {512.0, 256.0}) {
    const PacedSession session = paced(kbit_s);
    CAPTURE(kbit_s, to_seconds(session.oldest));
    CHECK(session.faded == 0);
    CHECK(session.samples > 29 * 60);
    CHECK(static_cast<double>(session.ticks_heard) > 0.98 * static_cast<double>(session.ticks));
    CHECK(spent(session, LinkLevel::kLean) + spent(session, LinkLevel::kSparse) == 0s);
  }
}

// A hand that rests needs a page now and then, and many where it comes to a new place of the organ.
TEST_CASE("link pace: no force fades at 256 kbit/s where contact comes to new places, whose pages come") {
  const LinkConditions line{.delay = 0.01, .bandwidth = 256e3 / 8};
  for (const Time place : {Time{1500ms}, Time{5200ms}, Time{9300ms}}) {
    std::vector<Lacking> lacking{{10s, 12}};
    for (Time at = 10s + place; at < 40s; at += place) lacking.push_back({at, 30});
    for (Time at = 10s + 200ms; at < 40s; at += 400ms) lacking.push_back({at, 1});
    const PacedSession session = PacedPair(line, line, lacking).run(30s);
    CAPTURE(to_seconds(place), to_seconds(session.oldest), session.pages,
            to_seconds(spent(session, LinkLevel::kPlain)), to_seconds(spent(session, LinkLevel::kPacked)));
    CHECK(session.faded == 0);
    CHECK(session.pages > 100);
  }
}

TEST_CASE("link pace: there is a force at 64 kbit/s, which fades in trials alone") {
  const PacedSession session = paced(64, 120s);
  CHECK(session.samples > 25 * 120);
  CHECK(static_cast<double>(session.faded) < 0.05 * static_cast<double>(session.ticks));
  CHECK(to_seconds(spent(session, LinkLevel::kSparse)) > 100);
}

TEST_CASE("link pace: a line that becomes wider is used again") {
  // One that is narrow for as long as another client fills it: a queue of 0.3 s that another empties.
  PacedPair pair({.delay_steps = {{10s, 0.01}, {12s, 0.15}, {13s, 0.2}, {14s, 0.25}, {20s, 0.01}}},
                 {.delay = 0.01});
  const PacedSession session = pair.run(90s);
  CHECK(session.level == LinkLevel::kFull);
}

TEST_CASE("link pace: neither loss alone, nor a way that becomes longer at once, takes anything away") {
  const PacedSession lossy = PacedPair({.delay = 0.02, .loss = 0.4}, {.delay = 0.02, .loss = 0.2}).run(30s);
  CHECK(to_seconds(spent(lossy, LinkLevel::kFull)) > 28);
  const PacedSession longer =
      PacedPair({.delay = 0.01}, {.delay_steps = {{10s, 0.01}, {20s, 0.12}}}).run(30s);
  CHECK(to_seconds(spent(longer, LinkLevel::kFull)) > 28);
}

TEST_CASE("link pace: jitter of 40 and of 80 ms each way is no queue") {
  for (const double jitter : {0.04, 0.08}) {
    const PacedSession session =
        PacedPair({.delay = 0.01, .jitter = jitter}, {.delay = 0.01, .jitter = jitter}).run(120s);
    CAPTURE(jitter, to_seconds(spent(session, LinkLevel::kPlain)),
            to_seconds(spent(session, LinkLevel::kSparse)));
    CHECK(to_seconds(spent(session, LinkLevel::kFull)) > 110);
    CHECK(spent(session, LinkLevel::kLean) + spent(session, LinkLevel::kSparse) == 0s);
  }
}

// The report calls a link slow that is packed for more than 2 s, or that carries less than that.
TEST_CASE("link pace: a quick link that stalls again and again is no slow one") {
  for (const auto& [every, length] : {std::pair<Time, Time>{5s, 500ms}, {3s, 350ms}}) {
    const PacedSession session = PacedPair({.delay = 0.02}, stalled(every, length, 600s)).run(600s);
    CAPTURE(to_seconds(every), to_seconds(spent(session, LinkLevel::kFull)));
    REQUIRE(session.samples < 17500);  // of 18000: the link did lose
    CHECK(to_seconds(spent(session, LinkLevel::kFull)) > 0.8 * 600);
    CHECK(to_seconds(spent(session, LinkLevel::kPacked)) < 2);
    CHECK(spent(session, LinkLevel::kPlain) + spent(session, LinkLevel::kLean) +
              spent(session, LinkLevel::kSparse) ==
          0s);
  }
}

TEST_CASE("link pace: trials that failed make the next ones rare, until no queue came for long") {
  LinkPace pace;
  ForceSample sample{.number = 0};
  Time t = 10s;
  const auto tell = [&](Time age) {
    ++sample.number;
    pace.sample(sample, age, t);
    t += 50ms;
  };
  const auto quick = [&](Time span) {
    for (const Time end = t + span; t < end;) tell(30ms);
  };
  const auto fill = [&] {
    for (int i = 1; i <= 9; ++i) tell(30ms + i * 40ms);
  };
  for (const Time calm : {Time{3s}, Time{12s}, Time{22500ms}}) {
    quick(calm);
    REQUIRE(pace.level() == LinkLevel::kFull);
    fill();
    REQUIRE(pace.level() == LinkLevel::kPacked);
  }
  quick(36s);  // of 40 s: a trial that is waited for makes the wait no shorter
  CHECK(pace.level() == LinkLevel::kPacked);
  // Late for a moment each 3 s, so that it is never calm for longer. 80 + 40 + 20 + 10 s later 2.5 s do.
  for (int i = 0; i < 50; ++i) {
    for (int late = 0; late < 3; ++late) tell(100ms);
    quick(2850ms);
  }
  CHECK(pace.level() == LinkLevel::kFull);
}

TEST_CASE("link pace: at one step a second, too, twenty states a second leave at least") {
  LinkPace pace;
  int left = 0;
  for (Time t = 10s; t < 12s; t += 2ms) left += pace.is_due(t, 1) ? 1 : 0;
  CHECK(left >= 40);
  CHECK(left <= 42);
}

TEST_CASE("link pace: a slow server and a pause are no slow link") {
  LinkPace pace;
  ForceSample sample{.number = 0};
  Time t = 10s;
  const auto tell = [&](Time age, Time step, std::uint32_t flags) {
    ++sample.number;
    sample.step_ns = step.count();
    sample.flags = flags;
    pace.sample(sample, age, t);
    t += 50ms;
  };
  for (int i = 0; i < 60; ++i) tell(30ms, 5ms, 0);
  REQUIRE(pace.level() == LinkLevel::kFull);
  for (int i = 0; i < 100; ++i) tell(30ms + i * 5ms, i * 5ms, 0);  // steps that take longer and longer
  CHECK(pace.level() == LinkLevel::kFull);
  for (int i = 0; i < 100; ++i) tell(30ms + i * 100ms, 5ms, ForceSample::kPaused);
  CHECK(pace.level() == LinkLevel::kFull);
}
