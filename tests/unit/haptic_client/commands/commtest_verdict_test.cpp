#include "haptic_client/commands/commtest_verdict.h"

#include "haptic_client/extrapolation/extrapolators.h"
#include "tests/support/catch.h"

using namespace palpate::client;

namespace {

/// Of a link with which nothing is wrong.
TestedLink good() {
  return {.law = "two_tangents",
          .seconds = 10,
          .age_p99_ms = 20,
          .stiffest_n_m = 50,
          .samples_hz = 30,
          .rate_hz = 30,
          .connected = true};
}

Grade grade_of(const TestedLink& link) {
  return judge(link).grade;
}

}  // namespace

TEST_CASE("commtest: every law has a row, and only a law that exists") {
  for (const ExtrapolatorRow& row : extrapolators()) {
    CAPTURE(row.name);
    CHECK(stable_to(row.name, 10));
  }
  CHECK_FALSE(stable_to("no such law", 10));
}

// As printed by `studies stability --by-delay`: constant 154 N/m at 15 ms, 95 at 38.
TEST_CASE("commtest: between two ages of the study the smaller stiffness counts, beyond the last none") {
  CHECK(stable_to("constant", 0) == 271);
  CHECK(stable_to("constant", 15) == 154);
  CHECK(stable_to("constant", 16) == 95);
  CHECK(stable_to("constant", 38) == 95);
  CHECK(stable_to("constant", 200) == 56);
  CHECK_FALSE(stable_to("constant", 200.1));
  // Two tangents are worse at 15 ms than at 38: the worse of both neighbours.
  CHECK(stable_to("two_tangents", 20) == 2497);
  CHECK(stable_to("two_tangents", 5) == 2497);
}

TEST_CASE("commtest: a longer age never gives a higher limit") {
  for (const ExtrapolatorRow& row : extrapolators()) {
    CAPTURE(row.name);
    for (int age = 1; age <= 200; ++age) CHECK(*stable_to(row.name, age) <= *stable_to(row.name, age - 1));
  }
  // The study has 2497 N/m at 15 ms and 7735 at 83.
  CHECK(stable_to("two_tangents", 108) == 2497);
}

TEST_CASE("commtest: ages are judged by what a hand can tell") {
  TestedLink link = good();
  link.age_p99_ms = 36;
  CHECK(grade_of(link) == Grade::kPass);
  CHECK_THAT(judge(link).reasons.back(), Catch::Contains("in a damper alone"));
  link.age_p99_ms = 137;
  CHECK(grade_of(link) == Grade::kWarn);
  CHECK_THAT(judge(link).reasons.back(), Catch::Contains("137 ms old"));
  REQUIRE(judge(link).remedies.size() == 1);
  CHECK_THAT(judge(link).remedies[0], Catch::Contains("late without being lost"));
}

TEST_CASE("commtest: bursts, pages that never come and a narrow uplink are named, with a remedy each") {
  CHECK(judge(good()).remedies.empty());
  TestedLink link = good();
  link.gaps = 3, link.longest_gap_ms = 500, link.faded = 3;
  CHECK(grade_of(link) == Grade::kFail);
  CHECK_THAT(judge(link).reasons.back(),
             Catch::Contains("3 times, once for 500 ms; the force faded 3 times"));
  CHECK_THAT(judge(link).remedies.at(0), Catch::Contains("bursts"));
  link.longest_gap_ms = 299;
  CHECK(grade_of(link) == Grade::kWarn);
  link = good();
  link.drops_large = true;
  CHECK(grade_of(link) == Grade::kFail);
  CHECK_THAT(judge(link).reasons.back(), Catch::Contains("937 bytes") && Catch::Contains("fragments"));
  link.drops_large = false;
  CHECK(grade_of(link) == Grade::kPass);
  link = good();
  link.sent_mbit_s = 0.8, link.uplink_loss_percent = 50;
  CHECK(grade_of(link) == Grade::kWarn);
  CHECK_THAT(judge(link).reasons.back(), Catch::Contains("your uplink carries 0.4 of the 0.8 Mbit/s"));
  CHECK_THAT(judge(link).remedies.at(0), Catch::Contains("rate_hz"));
  link = good();
  link.sent_mbit_s = 0.19, link.slow_percent = 80;
  CHECK(grade_of(link) == Grade::kWarn);
  CHECK_THAT(judge(link).reasons.at(0), Catch::Contains("the link is slow: in 80 % of the time"));
  CHECK_THAT(judge(link).remedies.at(0), Catch::Contains("2 Mbit/s"));
}

TEST_CASE("commtest: a good link passes, and each fault has its grade and its reason") {
  CHECK(grade_of(good()) == Grade::kPass);
  TestedLink link = good();
  link.stiffest_n_m = 2000;
  CHECK(grade_of(link) == Grade::kWarn);
  link.stiffest_n_m = 3000;
  CHECK(grade_of(link) == Grade::kFail);
  CHECK_THAT(judge(link).reasons[0], Catch::Contains("stable up to 2497 N/m") && Catch::Contains("3000"));
  link = good();
  link.stiffest_n_m = 0;
  CHECK(grade_of(link) == Grade::kWarn);
  link = good();
  link.age_p99_ms = 250;
  CHECK(grade_of(link) == Grade::kWarn);
  link.age_p99_ms = 301;
  CHECK(grade_of(link) == Grade::kFail);
  link = good();
  link.loss_percent = 5.1;
  CHECK(grade_of(link) == Grade::kWarn);
  link = good();
  link.samples_hz = 26;
  CHECK(grade_of(link) == Grade::kWarn);
  link.rate_hz = 0;  // as fast as it can
  CHECK(grade_of(link) == Grade::kPass);
  link = good();
  link.connected = false;
  CHECK(grade_of(link) == Grade::kFail);
}

TEST_CASE("commtest: each fault by itself names what helps against it, and a fault of two figures once") {
  const auto remedy_of = [](const auto& spoil) {
    TestedLink link = good();
    spoil(link);
    const Verdict verdict = judge(link);
    CHECK(verdict.grade != Grade::kPass);
    return verdict.remedies.size() == 1 ? verdict.remedies[0] : "";
  };
  // As printed by `studies stability --by-delay`: the tangent keeps 9614 N/m at 38 ms, two tangents 2497.
  const std::string other_law = remedy_of([](TestedLink& link) { link.stiffest_n_m = 3000; });
  CHECK_THAT(other_law, Catch::Contains("`--method tangent`, stable up to 9614 N/m"));
  CHECK_THAT(other_law, Catch::Contains("`[material] young_modulus`"));
  const std::string softer =
      remedy_of([](TestedLink& link) { link.stiffest_n_m = 20000, link.law = "tangent"; });
  CHECK_THAT(softer, Catch::Contains("`[material] young_modulus`") && !Catch::Contains("--method"));
  CHECK_THAT(remedy_of([](TestedLink& link) { link.samples_hz = 26; }),
             Catch::Contains("does not hold the rate") && Catch::Contains("`sim_server explain SCENE`"));
  CHECK_THAT(remedy_of([](TestedLink& link) { link.samples_hz = 26, link.loss_percent = 13; }),
             Catch::Contains("use a cable"));
  CHECK_THAT(remedy_of([](TestedLink& link) { link.stiffest_n_m = 0; }), Catch::Contains("`--client`"));
  CHECK_THAT(remedy_of([](TestedLink& link) { link.connected = false; }), Catch::Contains("sent no sample"));
  CHECK_THAT(remedy_of([](TestedLink& link) { link.drops_large = true; }), Catch::Contains("mtu 1280"));
  CHECK_THAT(remedy_of([](TestedLink& link) { link.age_p99_ms = 250; }),
             Catch::Contains("late without being lost"));
  CHECK_THAT(remedy_of([](TestedLink& link) { link.age_p99_ms = 301; }),
             Catch::Contains("late without being lost"));
  CHECK_THAT(remedy_of([](TestedLink& link) {
               link.gaps = 3, link.longest_gap_ms = 500, link.age_p99_ms = 400, link.loss_percent = 20,
               link.samples_hz = 20, link.uplink_loss_percent = 20;
             }),
             Catch::Contains("in bursts"));
}

// As measured over relays of 0.1 and 0.256 Mbit/s, which lose nothing in bursts: the queue does all of it.
TEST_CASE("commtest: a slow link comes first, and its queue is no burst") {
  TestedLink link = good();
  link.slow_percent = 88, link.sent_mbit_s = 0.19;
  link.gaps = 9, link.longest_gap_ms = 420, link.faded = 2, link.age_p99_ms = 376, link.loss_percent = 8;
  link.samples_hz = 25;
  const Verdict verdict = judge(link);
  CHECK(verdict.grade == Grade::kFail);
  CHECK_THAT(verdict.reasons.at(0), Catch::Contains("the link is slow: in 88 % of the time"));
  REQUIRE(verdict.remedies.size() == 1);
  CHECK_THAT(verdict.remedies[0], Catch::Contains("2 Mbit/s"));
  // What a queue does not make is named behind it.
  link.stiffest_n_m = 20000, link.age_p99_ms = 150, link.uplink_loss_percent = 6;
  const auto remedies = judge(link).remedies;
  REQUIRE(remedies.size() == 3);
  CHECK_THAT(remedies[0], Catch::Contains("2 Mbit/s"));
  CHECK_THAT(remedies[1], Catch::Contains("young_modulus"));
  CHECK_THAT(remedies[2], Catch::Contains("lower `rate_hz`"));
}

TEST_CASE("commtest: a gap that neither lasts nor comes back often hides no other cause") {
  const auto first_remedy = [](double gap_ms, std::uint64_t gaps, const auto& spoil) {
    TestedLink link = good();
    link.gaps = gaps, link.longest_gap_ms = gap_ms;
    spoil(link);
    CHECK(judge(link).grade != Grade::kPass);
    CHECK_THAT(judge(link).reasons.back(), Catch::Contains("no sample came for more than 100 ms"));
    return judge(link).remedies.at(0);
  };
  const auto few_steps = [](TestedLink& link) { link.samples_hz = 26; };
  const auto narrow = [](TestedLink& link) { link.sent_mbit_s = 0.8, link.uplink_loss_percent = 20; };
  const auto late = [](TestedLink& link) { link.age_p99_ms = 60; };
  const auto lossy = [](TestedLink& link) { link.loss_percent = 8; };
  CHECK_THAT(first_remedy(120, 1, few_steps), Catch::Contains("does not hold the rate"));
  CHECK_THAT(first_remedy(120, 1, narrow), Catch::Contains("lower `rate_hz`"));
  CHECK_THAT(first_remedy(120, 1, late), Catch::Contains("late without being lost"));
  CHECK_THAT(first_remedy(120, 1, lossy), Catch::Contains("single samples are lost"));
  CHECK_THAT(first_remedy(120, 1, [](TestedLink&) {}), Catch::Contains("now and then"));
  // In 10 s four gaps are more than one in 3 s, three are not; 300 ms are those at which the force fades.
  CHECK_THAT(first_remedy(120, 3, few_steps), Catch::Contains("does not hold the rate"));
  CHECK_THAT(first_remedy(120, 4, few_steps), Catch::Contains("in bursts"));
  CHECK_THAT(first_remedy(300, 1, few_steps), Catch::Contains("does not hold the rate"));
  CHECK_THAT(first_remedy(301, 1, few_steps), Catch::Contains("in bursts"));
}
