// Up to which stiffness a wall stays stable in a hand: operators x laws x walls x rates x latencies, closed
// loop in virtual time.
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "common/text.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "tests/studies/press_and_slide.h"
#include "tests/studies/studies.h"
#include "tests/support/random.h"

using namespace palpate;
using namespace palpate::client;
using namespace palpate::studies;

namespace {

constexpr double kFree = 1.3, kApproach = 0.5, kWatch = 4.0, kEnd = 6.0;  // s
constexpr double kSwing = 0.15e-3;                                        // m, beyond which, together with
constexpr double kSpeed = 2e-3;  // m/s RMS, a loop counts as unstable
constexpr double kSoftest = 20, kStiffest = 51200, kStep = 1.19, kPrecision = 1.05;  // N/m; ratios
const std::string kSlides = PressAndSlide::kRests,
                  kSwings = PressAndSlide::kSwings;  // worlds; others are walls
constexpr Link kUsual{30, 38};
constexpr const char* kSolves = "local_contact";   // the law that is told a compliance,
constexpr std::array<double, 2> kWrong{0.7, 1.3};  // also one so many times the true one

const std::vector<Person> kPersons{
    {"light", {.mass = 0.1, .device_damping = 1, .hand_stiffness = 200, .hand_damping = 5}},
    {"typical", {.mass = 0.3, .device_damping = 2, .hand_stiffness = 300, .hand_damping = 10}},
    {"heavy_loose", {.mass = 0.6, .device_damping = 1, .hand_stiffness = 100, .hand_damping = 5}}};

bool is_slide(const std::string& world) {
  return world == kSlides || world == kSwings;
}

test::Organ organ_of(const std::string& world, double stiffness) {
  return world == "linear" ? test::wall(stiffness) : test::hertz_wall(stiffness, kPress);
}

/// How deep the press is, m.
double depth_of(const std::string& world, double stiffness) {
  return world == "linear" ? kPress / stiffness : 1.5 * kPress / stiffness;
}

/// What is seen of a hand that presses.
class Watch {
 public:
  void see(double t, double start, const Vec3& place, const Vec3& rendered, const Vec3& right) {
    if (t > start) errors_.add(rendered, right);
    if (t >= kWatch) {
      ++watched_;
      low_ = std::min(low_, place[1]);
      high_ = std::max(high_, place[1]);
      speed2_ += ((place - place_) * kHapticHz).squaredNorm();
    }
    place_ = place;
  }
  Outcome result(bool latched) const {
    const bool moves = high_ - low_ > kSwing && std::sqrt(speed2_ / watched_) > kSpeed;
    return {!moves && !latched, errors_.rms()};
  }

 private:
  Vec3 place_ = Vec3::Zero();
  double low_ = 1, high_ = -1, speed2_ = 0;
  ForceErrors errors_;
  int watched_ = 0;
};

/// The true force at the haptic rate, without a law or a link: what no law can beat by much.
Outcome run_direct(Encoder& device, const test::Organ& organ, double start) {
  Watch watch;
  for (int tick = 0; tick < kEnd * kHapticHz; ++tick) {
    const double t = tick / kHapticHz;
    const Vec3 f = clamped(organ(device.read(from_seconds(1 + t)).p_D).f_W);
    device.write(f);
    watch.see(t, start, device.place(), f, organ(device.place()).f_W);
  }
  return watch.result(false);
}

/// Against a wall.
Outcome run(const Cell& cell, double stiffness, int seed) {
  test::Random random(static_cast<std::uint64_t>(seed) + 17);
  const double start = kFree + random.between(0, 1 / cell.link.rate_hz);
  const double target = -depth_of(cell.world, stiffness) - kPress / cell.person->hand.hand_stiffness;
  SimulatedOperator hand(
      cell.person->hand,
      Trajectory({0, start, start + kApproach}, {Vec3(0, 0.005, 0), Vec3(0, 0.005, 0), Vec3(0, target, 0)}));
  Encoder device(hand, random.between(0, kEncoder));
  const test::Organ organ = organ_of(cell.world, stiffness);
  if (cell.law == kDirect) return run_direct(device, organ, start);
  Pipeline pipeline = pipeline_of(cell);
  test::ClosedLoop loop(device, pipeline, test::served(organ), loop_of(cell.link, seed));
  Watch watch;
  while (loop.seconds() < kEnd) {
    const Vec3 rendered = loop.tick().f_D;
    watch.see(loop.seconds(), start, device.place(), rendered, organ(device.place()).f_W);
  }
  return watch.result(pipeline.limiter().fault() != Fault::kNone);
}

bool stable(const Cell& cell, double stiffness) {
  for (int seed = 1; seed <= kSeeds; ++seed) {
    if (!run(cell, stiffness, seed).stable) return false;
  }
  return true;
}

/// The stiffness below the first unstable one, within 5 %; the end of the axis if there is none.
double threshold(const Cell& cell) {
  double good = 0, bad = kSoftest;
  while (bad < kStiffest && stable(cell, bad)) {
    good = bad;
    bad *= kStep;
  }
  if (bad >= kStiffest) return kStiffest;
  while (good > 0 && bad / good > kPrecision) {
    const double middle = std::sqrt(good * bad);
    (stable(cell, middle) ? good : bad) = middle;
  }
  return good;
}

/// `slides`: of this thread.
Json row_of(const Cell& cell, double direct, PressAndSlide& slides) {
  const bool slide = is_slide(cell.world);
  const double limit = slide ? slides.threshold(cell) : threshold(cell);
  double error = 0;
  for (int seed = 1; seed <= kSeeds && limit > 0; ++seed)
    error += (slide ? slides.run(cell, limit, seed, true) : run(cell, limit / 2, seed)).force_error / kSeeds;
  const std::string world =
      cell.compliance == 1 ? cell.world : fmt::format("{}_compliance_{:g}", cell.world, cell.compliance);
  return {{"operator", cell.person->name},
          {"method", cell.law},
          {"passivity", cell.passivity},
          {"rate_hz", cell.link.rate_hz},
          {"delay_ms", cell.link.delay_ms},
          {"world", world},
          {"stable_to_n_m", limit},
          {"direct_limit_n_m", direct},
          {"force_error_percent", cell.world == kSwings || limit == 0 ? Json() : Json(100 * error)}};
}

std::vector<Cell> cells(bool quick) {
  const std::vector<Link> links =
      quick ? std::vector<Link>{kUsual} : std::vector<Link>{{30, 0}, kUsual, {30, 83}, {10, 105}, {100, 15}};
  // The quick study has no time for all hands on elements.
  const auto slid = [quick](const Person& person) { return !quick || &person == &kPersons[1]; };
  std::vector<Cell> all;
  for (const std::string& world : {std::string("linear"), std::string("hertz"), kSlides, kSwings}) {
    if (!PressAndSlide::has(world)) continue;
    for (const Person& person : kPersons) {
      for (const Link& link : links) {
        if (is_slide(world) && (link.rate_hz > 30 || !slid(person))) continue;  // no simulation is as fast
        if (world == kSwings && link.rate_hz < 30) continue;                    // its steps have one length
        for (const ExtrapolatorRow& row : extrapolators()) {
          for (const bool passivity : {false, true})
            all.push_back({&person, std::string(row.name), world, passivity, link});
        }
      }
    }
  }
  for (const Person& person : kPersons) {
    if (!slid(person)) continue;
    for (const double compliance : kWrong) {
      for (const bool passivity : {false, true})
        all.push_back({&person, kSolves, kSlides, passivity, kUsual, compliance});
    }
  }
  return all;
}

/// What `haptic_client commtest` judges a link by: every law on walls, by delay.
std::vector<Cell> cells_by_delay() {
  std::vector<Cell> all;
  for (const char* world : {"linear", "hertz"}) {
    for (const Person& person : kPersons) {
      for (const double delay_ms : {0.0, 15.0, 38.0, 60.0, 83.0, 120.0, 200.0}) {
        for (const ExtrapolatorRow& row : extrapolators())
          all.push_back({&person, std::string(row.name), world, true, {30, delay_ms}});
      }
    }
  }
  return all;
}

void study(const std::vector<Cell>& all, const std::filesystem::path& out) {
  std::filesystem::create_directories(out);
  std::vector<Cell> walls;  // one for each operator and world
  for (const Cell& cell : all) {
    const bool known = std::ranges::any_of(
        walls, [&](const Cell& wall) { return wall.person == cell.person && wall.world == cell.world; });
    if (!known) walls.push_back({cell.person, kDirect, cell.world, false, cell.link});
  }
  std::vector<double> limits(walls.size());
  for_all(walls.size(), "direct limits", [&] {
    return [&](std::size_t k) {
      limits[k] = is_slide(walls[k].world) ? PressAndSlide::stiffnesses().back() : threshold(walls[k]);
    };
  });
  const auto direct = [&](const Cell& cell) {
    const auto wall = std::ranges::find_if(
        walls, [&](const Cell& w) { return w.person == cell.person && w.world == cell.world; });
    return limits[static_cast<std::size_t>(wall - walls.begin())];
  };
  std::vector<Json> rows(all.size());
  for_all(all.size(), "laws", [&] {
    return [&, slides = PressAndSlide()](std::size_t k) mutable {
      rows[k] = row_of(all[k], direct(all[k]), slides);
    };
  });
  write_csv(out / "stability.csv", csv_of(Json(rows)));
  write_json(out / "summary.json", rows);
}

}  // namespace

Pipeline palpate::studies::pipeline_of(const Cell& cell) {
  return {find_row(extrapolators(), cell.law, "law", "study").make(),
          {},
          {.max_force = kClamp, .max_slew = 1e5},
          {.enabled = cell.passivity}};
}

Command palpate::studies::stability_command() {
  struct Options {
    std::filesystem::path out;
    bool quick = false, by_delay = false;
  };
  const auto options = std::make_shared<Options>();
  return {
      .name = "stability",
      .summary = "Up to which stiffness a wall stays stable in a hand: hands, laws, walls, rates, latencies",
      .footer = "Example: studies stability out/stability --quick",
      .options = {{"DIR", "Folder for stability.csv and summary.json", &options->out, {.required = true}},
                  quick_option(options->quick),
                  {"--by-delay", "Every law on walls, by delay: what `haptic_client commtest` judges by",
                   &options->by_delay}},
      .run = [options] {
        study(options->by_delay ? cells_by_delay() : cells(options->quick), options->out);
        return 0;
      }};
}
