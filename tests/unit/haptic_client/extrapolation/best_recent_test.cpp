#include "haptic_client/extrapolation/best_recent.h"

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;
using namespace std::chrono_literals;

namespace {

/// Gives the force it is told to, whatever the samples say.
struct Published : Extrapolator {
  explicit Published(const double* force) : force_n(force) {}
  void update(const Sample&) noexcept override {}
  void restart() noexcept override {}
  Vec3 force(const Vec3&, Time) noexcept override { return {0, *force_n, 0}; }
  const double* force_n;
};

/// Two laws: what they give, N; the second is trusted more.
struct Two {
  double first = 0, second = 0;
  Time now{};
  std::uint64_t number = 0;
  bool cuts = false;  // before each sample
  bool cutting = false;
  std::unique_ptr<BestRecent> law;

  Two() {
    std::vector<BestRecent::Law> laws;
    laws.push_back({"first", std::make_unique<Published>(&first)});
    laws.push_back({"second", std::make_unique<Published>(&second)});
    law = std::make_unique<BestRecent>(std::move(laws));
  }
  /// Ticks of 2 ms; every 30 ms a sample of 20 ms ago, when the force was 1 N.
  void move_to(double seconds, double right = 1) {
    for (const Time end = now + from_seconds(seconds); now < end; now += 2ms) {
      if (now.count() % 30'000'000 == 0 && now > 20ms) {
        if (cuts) law->surface_cut();
        law->update({.number = ++number, .t = now - 20ms, .f = {0, right, 0}, .cutting = cutting});
      }
      law->start_tick(now);
      law->force(Vec3::Zero(), now);
    }
  }
  double rendered() { return law->force(Vec3::Zero(), now)[1]; }
};

}  // namespace

TEST_CASE("best recent: without a sample, and of equals, the most trusted law") {
  Two laws;
  laws.first = laws.second = 1.5;
  CHECK(laws.law->substitute() == "second");
  laws.move_to(1);
  CHECK(laws.law->substitute() == "second");
}

TEST_CASE("best recent: the law whose predictions were better by a fifth takes over, not one a bit better") {
  Two laws;
  laws.first = 1.5, laws.second = 1.55;  // off by 0.5 and 0.55 N
  laws.move_to(3);
  CHECK(laws.law->substitute() == "second");
  laws.first = 1.1;
  laws.move_to(3);
  CHECK(laws.law->substitute() == "first");
  CHECK(laws.rendered() == 1.1);
  laws.second = 1.09;
  laws.move_to(3);
  CHECK(laws.law->substitute() == "first");
  laws.second = 1.01;
  laws.move_to(3);
  CHECK(laws.law->substitute() == "second");
}

TEST_CASE(
    "best recent: what a law gave when the tool was there counts, not what it gives when the sample comes") {
  Two laws;
  laws.first = 1, laws.second = 2;
  laws.move_to(0.1);  // the first is right at the ticks that samples answer ...
  laws.law->restart();
  laws.move_to(0.05);
  CHECK(laws.law->substitute() == "second");  // forgotten
  laws.move_to(0.1);
  CHECK(laws.law->substitute() == "first");
}

TEST_CASE("best recent: what laws gave until tissue went counts, too, however often it goes") {
  Two laws;
  laws.first = 1, laws.second = 0.4;
  laws.cuts = true;
  laws.move_to(0.3);
  CHECK(laws.law->substitute() == "first");
}

TEST_CASE(
    "best recent: a law that only looks back gives nothing where the tool is free, and time there counts for "
    "none") {
  Two laws;
  laws.first = 1, laws.second = 3;
  laws.move_to(1);
  REQUIRE(laws.law->substitute() == "first");
  laws.move_to(0.1, 0);
  CHECK(laws.rendered() == 0);
  laws.move_to(5, 0);  // nobody pushes: nothing is learned
  CHECK(laws.law->substitute() == "first");
  laws.move_to(0.1);
  CHECK(laws.rendered() == 1);
}

TEST_CASE(
    "best recent: for eight samples from a cut on no law gives more than the largest of the last eight") {
  Two laws;
  laws.first = laws.second = 1.2;
  laws.move_to(1);
  CHECK(laws.rendered() == 1.2);
  laws.cuts = true;
  laws.move_to(0.03);
  laws.cuts = false;
  CHECK(laws.rendered() == Approx(1));
  laws.move_to(0.03, 0.7);  // a seventh of the window on, that of 1 N is the largest still
  CHECK(laws.rendered() == Approx(1));
  laws.first = laws.second = 0.4;  // less is given as it is
  CHECK(laws.rendered() == 0.4);
  laws.first = laws.second = 1.2;
  laws.move_to(0.18, 0.7);
  CHECK(laws.rendered() == Approx(1));
  laws.move_to(0.03, 0.7);
  CHECK(laws.rendered() == 1.2);
  laws.cuts = true;
  laws.move_to(0.03, 0.7);
  CHECK(laws.rendered() == Approx(0.7));
  laws.law->restart();
  laws.cuts = false;
  laws.move_to(0.03, 0.7);
  CHECK(laws.rendered() == 1.2);
}

TEST_CASE(
    "best recent: while the tool cuts no law gives 3 % more than the largest of the last eight samples") {
  Two laws;
  laws.first = laws.second = 1.2;
  laws.move_to(1);
  REQUIRE(laws.rendered() == 1.2);
  laws.cutting = true;
  laws.move_to(1);
  CHECK(laws.rendered() == Approx(1.03));
  laws.cutting = false;
  laws.move_to(0.03);
  CHECK(laws.rendered() == 1.2);
}

TEST_CASE("best recent: from a cut on a law that was a bit better takes over, too") {
  Two laws;
  laws.first = 0.91, laws.second = 0.9;  // off by 0.09 and 0.1 N
  laws.move_to(3);
  REQUIRE(laws.law->substitute() == "second");
  laws.cuts = true;
  laws.move_to(0.03);
  CHECK(laws.law->substitute() == "first");
}
