#include "haptic_client/session/link_pace.h"

#include <algorithm>
#include <utility>

namespace palpate::client {
using namespace std::chrono_literals;
using protocol::ForceSample;
using protocol::ToolState;

namespace {

struct LevelRow {
  const char* name;
  double states_per_step;  // 0: each tick
  double pages_hz;         // below 0: as `PagePace` allows
  double telemetry_hz;     // below 0: as often as it is made
  std::uint16_t requests;  // parts of a sample that are asked for
};

constexpr std::uint16_t kTangentOnly = ToolState::kRequestsTangent | ToolState::kRequestsErrors;
constexpr std::uint16_t kAllParts = kTangentOnly | ToolState::kRequestsAhead | ToolState::kRequestsSurface;
// At 30 steps a second, without a key: packed, 500 ticks a second are 0.2 Mbit/s; sparse, 0.05 Mbit/s.
constexpr std::array<LevelRow, kLinkLevels> kLevels{{
    {"full", 0, -1, -1, kAllParts},
    {"packed", 2, -1, -1, kAllParts},
    {"plain", 2, 4, 4, kAllParts},
    {"lean", 2, 0, 1, kTangentOnly},
    {"sparse", 1.2, 0, 0, 0},  // 1: a step would now and then find no new state
}};

constexpr std::uint64_t kSamplesOfALook = 3;  // the least of them: a single late one says nothing
constexpr Time kGrows = 10ms;                 // from one look to the next: the queue grows
constexpr Time kFalls = 5ms;                  // the queue empties
constexpr int kLooksThatGrow = 2;             // a way that becomes longer at once grows in one
constexpr double kMostLost = 0.1;             // share of datagrams, in a look
constexpr Time kStallEnds = 50ms;             // once it is over, all that it held back has come by then
constexpr Time kSettles = 300ms;              // after a change, until its effect shows
constexpr Time kStays = 1500ms;               // as long below full: what is sent fills the link
constexpr Time kCalm = 25ms;                  // in a queue: no congestion
constexpr Time kCalmAfterFailure = 10s, kLongestCalm = 300s;
constexpr Time kTrial = 10s;  // congestion so soon after the level went up: it went too far

const LevelRow& row_of(LinkLevel level) {
  return kLevels[static_cast<std::size_t>(level)];
}

LinkLevel neighbour(LinkLevel level, int by) {
  const int index = std::clamp(static_cast<int>(level) + by, 0, static_cast<int>(kLinkLevels) - 1);
  return static_cast<LinkLevel>(index);
}

/// True if something that may happen `hz` times a second may at `now`; then it last happened at `now`.
bool may_happen(double hz, Time& last, Time now) {
  if (hz < 0) return true;
  if (hz == 0 || (last != Time{} && now - last < from_seconds(1 / hz))) return false;
  last = now;
  return true;
}

bool exceeds(std::uint64_t lost, std::uint64_t all, double share) {
  return all > 0 && static_cast<double>(lost) > share * static_cast<double>(all);
}

}  // namespace

const char* name_of(LinkLevel level) noexcept {
  return row_of(level).name;
}

bool LinkPace::is_due(Time now, double rate_hz) noexcept {
  if (ticked_ != Time{} && now > ticked_) spent_[static_cast<std::size_t>(level_)] += now - ticked_;
  ticked_ = now;
  const double per_step = row_of(level_).states_per_step;
  if (per_step == 0) return true;
  const double steps = rate_hz > 0 ? std::min(rate_hz, kMostSteps) : kMostSteps;
  return may_happen(std::max(per_step * steps, kFewestStates), sent_, now);
}

void LinkPace::shrink(ToolState& state) const noexcept {
  state.flags &= static_cast<std::uint16_t>(~kAllParts | row_of(level_).requests);
}

double LinkPace::pages_hz() const noexcept {
  return row_of(level_).pages_hz;
}

bool LinkPace::carries_telemetry(Time now) noexcept {
  return may_happen(row_of(level_).telemetry_hz, told_, now);
}

/// The server's own time is none of the link's. In a pause the same answer comes again, older each time.
void LinkPace::sample(const ForceSample& sample, Time age, Time now) noexcept {
  const bool paused = (sample.flags & ForceSample::kPaused) != 0;
  const bool began_anew = sample.number <= std::max(look_.newest, before_.newest);
  if (paused || began_anew) {
    look_ = before_ = {};
    if (paused) return;
  }
  const Time on_the_way = age - std::clamp(Time{sample.step_ns}, Time{}, age);
  least_.pass(now);
  least_.add(on_the_way);
  jitter_.add(on_the_way);
  if (look_.came == 0) look_ = {.began = now, .least_age = on_the_way};
  look_.least_age = std::min(look_.least_age, on_the_way);
  look_.newest = sample.number;
  look_.uplink = sample.uplink;
  if (++look_.came < kSamplesOfALook) return;
  judge(std::max(look_.least_age - *least_.least() - jitter_.most(), Time{}), now);
  before_ = std::exchange(look_, {});
}

/// True if in the newest look samples were lost, or states on their way to the server.
bool LinkPace::loses() const noexcept {
  if (before_.newest == 0) return false;
  const std::uint64_t samples = look_.newest - before_.newest;
  const protocol::UplinkCounts &then = before_.uplink, &now = look_.uplink;
  const std::uint64_t lost = now.lost > then.lost ? now.lost - then.lost : 0,
                      came = now.came > then.came ? now.came - then.came : 0;
  return exceeds(samples - std::min(samples, look_.came), samples, kMostLost) ||
         exceeds(lost, lost + came, kMostLost);
}

/// True if a queue grows, stays, or is still there after something was lost in it. A stall of a quick link
/// delays and loses as much, but once it is over nothing waits.
bool LinkPace::is_congested(Time delay, Time before, Time now) noexcept {
  const bool waits = delay > kWaits;
  grew_ = waits && delay > before + kGrows ? grew_ + 1 : 0;
  if (!waits || delay < before - kFalls)
    waits_since_.reset();
  else if (!waits_since_)
    waits_since_ = now;
  if (!waits)
    loses_since_.reset();
  else if (!loses_since_ && loses())
    loses_since_ = now;
  const bool stays = level_ != LinkLevel::kFull && waits_since_ && now - *waits_since_ > kStays;
  return grew_ >= kLooksThatGrow || (loses_since_ && now - *loses_since_ > kStallEnds) || stays;
}

void LinkPace::judge(Time delay, Time now) noexcept {
  const Time before = std::exchange(delay_, delay);
  if (now < settled_) return;
  if (delay > kCalm)
    calm_since_.reset();
  else if (!calm_since_)
    calm_since_ = now;
  if (is_congested(delay, before, now)) {
    if (raised_ != Time{} && now - raised_ < kTrial)
      calm_ = std::clamp(2 * calm_, kCalmAfterFailure, kLongestCalm);
    change(neighbour(level_, 1), now);
  } else if (level_ != LinkLevel::kFull && calm_since_ && now - *calm_since_ > calm_) {
    raised_ = now;
    change(neighbour(level_, -1), now);
  } else if (now - quiet_since_ > 2 * calm_) {  // once would be over just before the trial that may fail
    calm_ = std::max(calm_ / 2, kFirstCalm);
    quiet_since_ = now;
  }
}

void LinkPace::change(LinkLevel level, Time now) noexcept {
  if (level > level_) raised_ = {};
  level_ = level;
  settled_ = level > LinkLevel::kFull && raised_ != now ? now + std::max(kSettles, 2 * delay_) : now;
  grew_ = 0;
  quiet_since_ = now;
  calm_since_.reset(), waits_since_.reset(), loses_since_.reset();
}

}  // namespace palpate::client
