#include "haptic_client/commands/commtest_verdict.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>

#include "common/ages.h"
#include "common/perception.h"
#include "common/text.h"
#include "common/time.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/session/link_figures.h"

namespace palpate::client {
namespace {

constexpr std::array kAges{0.0, 15.0, 38.0, 60.0, 83.0, 120.0, 200.0};  // ms
struct Row {
  std::string_view law;
  std::array<double, kAges.size()> stable_to;  // N/m
};
// build/release/bin/studies stability DIR --by-delay
constexpr std::array<Row, 11> kRows{{
    {"constant", {271, 154, 95, 80, 77, 67, 56}},
    {"linear_time", {309, 141, 84, 61, 43, 28, 0}},
    {"linear_position", {323, 135, 135, 91, 84, 59, 41}},
    {"linear_position_signed", {1245, 1046, 738, 352, 879, 806, 499}},
    {"learned_stiffness", {4208, 3693, 2390, 1923, 2009, 2098, 2098}},
    {"tangent", {13615, 9614, 13615, 8814, 7735, 9205, 7735}},
    {"two_tangents", {14220, 2497, 13615, 10488, 7735, 9205, 8438}},
    {"local_contact", {14220, 2497, 13615, 10488, 7735, 9205, 8438}},
    {"best_recent", {14220, 2497, 13615, 10488, 7735, 9205, 8438}},
    {"kalman", {271, 129, 80, 59, 47, 29, 0}},
    {"interpolate_with_delay", {77, 80, 84, 80, 77, 67, 56}},
}};
constexpr double kDirect = 14220;  // N/m: what the true force at 500 Hz keeps stable, and no law exceeds

constexpr double kMostLoss = 5;                       // %
constexpr double kMostSlow = 10;                      // % of the time
constexpr double kBetweenBursts = 3;                  // s: gaps that are rarer come one by one
constexpr double kFades = 1e3 * to_seconds(kOutage);  // ms: of a sample at which the force fades

const std::string kBursts =
    "samples stay out in bursts, as on a radio link or behind traffic of others: use a cable, or a "
    "network of its own";
const std::string kLoneGap =
    "samples stay out now and then: a step of the server that takes long (its report counts late "
    "deadlines), or a moment of bad radio";
const std::string kLate =
    "samples are late without being lost: a long way, a queue on it (end other traffic), or a server "
    "that steps slowly (`sim_server explain SCENE`); a softer scene needs less";
const std::string kNothingCame =
    "the server answered and then sent no sample: look whether it still runs and steps (its own output "
    "says so), and let UDP through both ways";
const std::string kNothingTouched =
    "let the simulated hand press on the organ: give `--client` the file made for this scene";
const std::string kLarge =
    "let IP fragments pass, `ip link set dev IF mtu 1280` on the tunnel, or `--method two_tangents`";
const std::string kBadWayBack = "single samples are lost on the way back: use a cable, or look for a bad one";
const std::string kBadUplink =
    "the way to the server loses datagrams: give the client a lower `rate_hz`, or use a link that carries "
    "more";
const std::string kSlow =
    "the link is too slow: use one that carries 2 Mbit/s each way, or end other traffic on it";
const std::string kFewSteps =
    "the server does not hold the rate of its scene (`sim_server explain SCENE` says which it can): a lower "
    "`rate_hz`, a coarser mesh, or a faster machine for it";

/// A reason to grade a link no better, and what helps.
void worsen(Verdict& verdict, Grade grade, std::string reason, const std::string& remedy) {
  verdict.grade = std::max(verdict.grade, grade);
  verdict.reasons.push_back(std::move(reason));
  if (std::ranges::find(verdict.remedies, remedy) == verdict.remedies.end())
    verdict.remedies.push_back(remedy);
}

void note(Verdict& verdict, std::string reason) {
  verdict.reasons.push_back(std::move(reason));
}

bool is_slow(const TestedLink& link) {
  return link.slow_percent > kMostSlow;
}

/// True if samples stay out so long, or so often, that this is what spoils the other figures. The queue of a
/// slow link makes gaps too, and is no burst.
bool has_bursts(const TestedLink& link) {
  const bool often = static_cast<double>(link.gaps) * kBetweenBursts > link.seconds;
  return !is_slow(link) && link.gaps > 0 && (link.longest_gap_ms > kFades || often);
}

/// Outages in a row are one fault, whatever else they make of the figures.
const std::string& unless_in_bursts(const TestedLink& link, const std::string& remedy) {
  return has_bursts(link) ? kBursts : remedy;
}

/// The queue of a slow link delays samples and drops them.
const std::string& unless_slow_or_in_bursts(const TestedLink& link, const std::string& remedy) {
  return is_slow(link) ? kSlow : unless_in_bursts(link, remedy);
}

/// What helps where a scene is stiffer than a law keeps stable: the law that keeps most stable at this age,
/// if that is more.
std::string softer_or_other_law(const TestedLink& link, double limit) {
  constexpr const char* kSofter =
      "make the scene softer (`[material] young_modulus`), or its samples younger (a shorter way, a higher "
      "`rate_hz` of the scene)";
  const auto most = std::ranges::max_element(
      kRows, {}, [&](const Row& row) { return stable_to(row.law, link.age_p99_ms).value_or(0); });
  const double by_most = stable_to(most->law, link.age_p99_ms).value_or(0);
  if (by_most <= limit) return kSofter;
  return fmt::format("choose `--method {}`, stable up to {:.0f} N/m with samples of that age, or {}",
                     most->law, by_most, kSofter);
}

void judge_width(const TestedLink& link, Verdict& verdict) {
  if (!is_slow(link)) return;
  worsen(verdict, Grade::kWarn,
         fmt::format("the link is slow: in {:.0f} % of the time the ticks between travelled packed or not at "
                     "all, which left {:.2g} Mbit/s up",
                     link.slow_percent, link.sent_mbit_s),
         kSlow);
}

void judge_stiffness(const TestedLink& link, Verdict& verdict) {
  const auto limit = stable_to(link.law, link.age_p99_ms);
  if (!limit) {
    return worsen(verdict, Grade::kWarn,
                  fmt::format("of \"{}\" with samples {:.0f} ms old the stability study knows nothing",
                              link.law, link.age_p99_ms),
                  unless_slow_or_in_bursts(link, kLate));
  }
  const std::string law =
      fmt::format("with samples {:.1f} ms old (p99) \"{}\" is stable up to {:.0f} N/m on the study's walls",
                  link.age_p99_ms, link.law, *limit) +
      (find_row(extrapolators(), link.law, "law", "commtest").make()->request().surface
           ? " (no surface is told of these, so that a law without one stood in)"
           : "");
  if (link.stiffest_n_m == 0) {
    return worsen(verdict, Grade::kWarn,
                  law + "; nothing was touched, so how stiff the scene is is not known", kNothingTouched);
  }
  const double fraction = link.stiffest_n_m / *limit;
  std::string reason =
      fmt::format("{}; the scene has {:.0f} N/m, {:.2g} of that", law, link.stiffest_n_m, fraction);
  if (fraction <= 0.5) return note(verdict, std::move(reason));
  worsen(verdict, fraction > 1 ? Grade::kFail : Grade::kWarn, std::move(reason),
         softer_or_other_law(link, *limit));
}

void judge_ages(const TestedLink& link, Verdict& verdict) {
  if (link.age_p99_ms > kFades) {
    worsen(verdict, Grade::kFail,
           fmt::format("samples are older than the {:.0f} ms at which the force fades", kFades),
           unless_slow_or_in_bursts(link, kLate));
  } else if (link.age_p99_ms > kNoticedInSpring) {
    worsen(
        verdict, Grade::kWarn,
        fmt::format("a hand notices that a force is late from {:.0f} ms on in a spring and from {:.0f} ms on "
                    "in a damper; samples are {:.0f} ms old",
                    kNoticedInSpring, kNoticedInDamper, link.age_p99_ms),
        unless_slow_or_in_bursts(link, kLate));
  } else if (link.age_p99_ms > kNoticedInDamper) {
    note(verdict,
         fmt::format("a hand notices in a damper alone that a force is {:.0f} ms late", link.age_p99_ms));
  }
}

void judge_losses(const TestedLink& link, Verdict& verdict) {
  if (link.drops_large) worsen(verdict, Grade::kFail, large_datagrams_text(), kLarge);
  const bool loses = link.loss_percent > kMostLoss;
  if (loses) {
    worsen(verdict, Grade::kWarn,
           fmt::format("{:.1f} % of the samples were lost (the laws bridge one, not many in a row)",
                       link.loss_percent),
           unless_slow_or_in_bursts(link, kBadWayBack));
  }
  if (link.uplink_loss_percent > kMostLoss) {
    worsen(verdict, Grade::kWarn,
           fmt::format("your uplink carries {:.2g} of the {:.2g} Mbit/s that are sent",
                       link.sent_mbit_s * (1 - 0.01 * link.uplink_loss_percent), link.sent_mbit_s),
           unless_in_bursts(link, kBadUplink));
  }
  if (link.rate_hz > 0 && link.samples_hz < 0.9 * link.rate_hz) {
    worsen(verdict, Grade::kWarn,
           fmt::format("{:.1f} samples a second came, where the server aims for {:g}", link.samples_hz,
                       link.rate_hz),
           loses ? unless_slow_or_in_bursts(link, kBadWayBack) : unless_in_bursts(link, kFewSteps));
  }
}

void judge_gaps(const TestedLink& link, Verdict& verdict) {
  if (link.gaps == 0) return;
  worsen(verdict, link.longest_gap_ms > kFades ? Grade::kFail : Grade::kWarn,
         fmt::format(
             "no sample came for more than 100 ms {} times, once for {:.0f} ms; the force faded {} times "
             "(it fades after {:.0f} ms)",
             link.gaps, link.longest_gap_ms, link.faded, kFades),
         unless_slow_or_in_bursts(link, kLoneGap));
}

}  // namespace

std::optional<double> stable_to(std::string_view law, double age_ms) {
  const auto row = std::ranges::find_if(kRows, [&](const Row& r) { return r.law == law; });
  if (row == kRows.end() || age_ms > kAges.back()) return {};
  double least = kDirect;
  for (std::size_t i = 0; i < kAges.size() && (i == 0 || kAges[i - 1] < age_ms); ++i)
    least = std::min(least, row->stable_to[i]);
  return least;
}

Verdict judge(const TestedLink& link) {
  Verdict verdict;
  if (!link.connected) return {Grade::kFail, {"no session"}, {kNothingCame}};
  judge_width(link, verdict);
  judge_stiffness(link, verdict);
  judge_ages(link, verdict);
  judge_losses(link, verdict);
  judge_gaps(link, verdict);
  return verdict;
}

const char* name_of(Grade grade) {
  return grade == Grade::kPass ? "PASS" : grade == Grade::kWarn ? "WARN" : "FAIL";
}

}  // namespace palpate::client
