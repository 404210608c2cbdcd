/// How a session fares on bad networks, in virtual time: an organ palpated by the hand of its client file,
/// over links that lose, delay, scatter and reorder datagrams; and the same for a night.
#include <atomic>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/error.h"
#include "common/report.h"
#include "common/text.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/session/client_config.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/scene_file/read_scene.h"
#include "sim_server/serving/served_tools.h"
#include "sim_server/serving/surface_pager.h"
#include "sim_server/serving/tool_path.h"
#include "tests/support/linked_pair.h"

namespace palpate::studies {
namespace {

constexpr double kInitialize = 3, kFaultsEnd = 9, kHealed = 11, kEnd = 15;  // s
constexpr double kRemoved = 5;                                              // s
const std::filesystem::path kScene = PALPATE_SOURCE_DIR "/configs/scenes/liver_paper.toml",
                            kClient = PALPATE_SOURCE_DIR "/configs/clients/liver_paper.toml";
constexpr double kHaptic = 1000, kServed = 30;  // Hz
constexpr std::size_t kTicksPerLook = 7;        // at the right force: by and by at all phases of a step

/// One link, the same each way. Shares; s, of the round trip.
struct Conditions {
  double loss = 0, delay = 0, jitter = 0;
  bool bursts = false;  ///< the losses come in bursts of 8 on the mean
  double reordered = 0;
  double removed = 0;  ///< no network at all for so long, from `kRemoved` on
};

protocol::LinkConditions one_way(const Conditions& c) {
  protocol::LinkConditions link{
      .delay = c.delay / 2, .jitter = c.jitter / 2, .reordered = c.reordered, .reorder_delay = 0.04};
  if (!c.bursts) {
    link.loss = c.loss;
  } else if (c.loss > 0) {
    link.burst_end = 1.0 / 8;
    link.burst_start = link.burst_end * c.loss / (1 - c.loss);  // so that the share in bursts is `loss`
  }
  return link;
}

/// An organ with the hand that palpates it, and what the organ answers; one thread.
class Bench {
 public:
  Bench(const std::filesystem::path& scene, const std::filesystem::path& client)
      : config_(client::read_client_config(client)),
        simulation_(sim::read_scene(scene)),
        tools_(simulation_),
        pager_(simulation_, 0) {
    const sim::Scene right = sim::read_scene(scene);
    if (!sim::model_of(right.deformation).moves) right_.emplace(right);
  }

  std::unique_ptr<client::Device> hand() const { return client::row_of(config_.device).make(config_.device); }
  client::Pipeline pipeline() const {
    return {find_row(client::extrapolators(), config_.method, "method", config_.method_where).make(),
            config_.workspace, config_.device_limits(), config_.passivity, config_.blend};
  }
  test::Served served() {
    const auto heard = [this](std::uint64_t session, const protocol::ToolState& state) {
      if (std::exchange(input_.session, session) != session) input_.path = {};
      input_.path.add(state);
    };
    const auto step = [this](std::uint64_t, const protocol::ToolState& state) {
      input_.state = state;
      input_.fresh = true;
      auto answer = tools_.step(std::vector<sim::SessionInput>{input_}, 1 / kServed).front().answer;
      if (answer) answered_.emplace_back(state.tick, answer->f_W);
      return answer;
    };
    return {
        .step = step,
        .heard = heard,
        .page = [this](std::uint32_t number, protocol::SurfacePage& out) { return pager_.page(number, out); },
        .surface_version = pager_.state().version};
  }
  /// The force, N, that an organ which follows the tool at once has for it there: what should be felt.
  /// Nothing of one that moves by itself.
  std::optional<Vec3> right_at(const protocol::ToolState& tool) {
    if (!right_) return {};
    return right_->step(sim::pose_of(tool), kTicksPerLook / kHaptic).force;
  }
  /// The ticks that the organ answered since the last call, and the force there, N: what should be felt.
  std::vector<std::pair<std::uint64_t, Vec3>> take_answered() { return std::exchange(answered_, {}); }

 private:
  client::ClientConfig config_;
  sim::Simulation simulation_;
  sim::ServedTools tools_;
  sim::SurfacePager pager_;
  sim::SessionInput input_;
  std::vector<std::pair<std::uint64_t, Vec3>> answered_;
  std::optional<sim::Simulation> right_;
};

/// Of the felt force against the right one where the hand is, relative to the RMS of the right one.
class Errors {
 public:
  void add(const Vec3& rendered, const Vec3& right) {
    errors_.push_back((rendered - right).norm());
    squares_ += right.squaredNorm();
  }
  Json percent() {
    if (errors_.empty() || !(squares_ > 0)) return nullptr;
    std::ranges::sort(errors_);
    double sum = 0;
    for (const double e : errors_) sum += e;
    const double count = static_cast<double>(errors_.size()), rms = std::sqrt(squares_ / count);
    const auto at = [&](double fraction) {
      return errors_[static_cast<std::size_t>(fraction * (count - 1))];
    };
    return {{"mean", 100 * sum / count / rms},
            {"p99", 100 * at(0.99) / rms},
            {"max", 100 * errors_.back() / rms}};
  }

 private:
  std::vector<double> errors_;
  double squares_ = 0;
};

Json milliseconds(Time t) {
  return 1e3 * to_seconds(t);
}

Json run(Bench& bench, const Conditions& c, int seed) {
  const auto hand = bench.hand();
  client::Pipeline pipeline = bench.pipeline();
  protocol::LinkConditions link = one_way(c);
  if (c.removed > 0) link.partitions = {{from_seconds(1 + kRemoved), from_seconds(1 + kRemoved + c.removed)}};
  test::LinkedPair pair(*hand, pipeline, bench.served(),
                        {.haptic_hz = kHaptic,
                         .sim_hz = kServed,
                         .up = link,
                         .down = link,
                         .seed = static_cast<std::uint64_t>(seed),
                         .faults_end = kFaultsEnd});
  std::vector<Vec3> rendered{Vec3::Zero()};  // by tick
  std::vector<std::pair<std::uint64_t, Vec3>> rights;
  double most = 0, steepest = 0;
  while (pair.seconds() < kEnd) {
    const client::TickResult tick = pair.tick();
    if (rendered.size() % kTicksPerLook == 0) {
      if (const auto right = bench.right_at(tick.tool)) rights.emplace_back(rendered.size(), *right);
    }
    rendered.push_back(tick.f_D);
    most = std::max(most, rendered.back().norm());
    steepest = std::max(steepest, kHaptic * (rendered.back() - *(rendered.end() - 2)).norm());
  }
  Errors bad, healed;
  if (rights.empty()) rights = bench.take_answered();
  for (const auto& [tick, right] : rights) {
    const double t = static_cast<double>(tick) / kHaptic;
    if (t > kInitialize && t <= kFaultsEnd) bad.add(rendered[tick], right);
    if (t > kHealed) healed.add(rendered[tick], right);
  }
  const client::PipelineStats& stats = pipeline.stats();
  const bool itself = stats.published > stats.stepped_down;
  return {
      {"loss_percent", 100 * c.loss},
      {"bursts", c.bursts},
      {"delay_ms", 1e3 * c.delay},
      {"jitter_ms", 1e3 * c.jitter},
      {"reordered_percent", 100 * c.reordered},
      {"gone_ms", 1e3 * c.removed},
      {"welcomed_ms", pair.first_welcome() ? Json(1e3 * *pair.first_welcome()) : Json(nullptr)},
      {"law_itself_ms", itself ? milliseconds(stats.first_itself - stats.first_published) : Json(nullptr)},
      {"samples", stats.samples},
      {"age_ms_p50", 1e-6 * stats.age_ns.quantile(0.5)},
      {"age_ms_p99", 1e-6 * stats.age_ns.quantile(0.99)},
      {"error_percent", bad.percent()},
      {"healed_error_percent", healed.percent()},
      {"largest_newton", most},
      {"steepest_newton_s", steepest},
      {"fault", static_cast<int>(pipeline.limiter().fault())}};
}

std::vector<Conditions> all_conditions(bool quick) {
  std::vector<Conditions> all;
  for (const double delay : quick ? std::vector<double>{0.02, 0.2} : std::vector<double>{0, 0.02, 0.08, 0.2})
    for (const double loss : quick ? std::vector<double>{0, 0.1} : std::vector<double>{0, 0.02, 0.1, 0.3})
      for (const double jitter : {0.0, 0.03})
        for (const double reordered : {0.0, 0.1})
          for (const bool bursts : {false, true})
            if (!bursts || loss > 0) all.push_back({loss, delay, jitter, bursts, reordered});
  return all;
}

/// A few links for an organ that remembers: what was lost must not be made up, and the force must come back.
std::vector<Conditions> conditions_of_scene() {
  return {{.delay = 0.035},
          {.loss = 0.1, .delay = 0.035, .reordered = 0.1},
          {.loss = 0.1, .delay = 0.035, .jitter = 0.03, .reordered = 0.1},
          {.loss = 0.3, .delay = 0.035},
          {.delay = 0.035, .removed = 0.5},
          {.loss = 0.1, .delay = 0.08, .reordered = 0.1}};
}

Json study(const std::vector<Conditions>& all, const std::filesystem::path& scene,
           const std::filesystem::path& client) {
  std::vector<Json> rows(all.size());
  std::atomic<std::size_t> next{0}, done{0};
  {
    std::vector<std::jthread> workers;
    for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i)
      workers.emplace_back([&] {
        for (std::size_t k; (k = next++) < all.size();) {
          Bench bench(scene, client);  // anew: tissue may remember
          rows[k] = run(bench, all[k], 1);
          fmt::print(stderr, "links: {} of {}\n", ++done, all.size());
        }
      });
  }
  return rows;
}

/// Of this process, kB.
long resident_kb() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (long kb = 0; word == "VmRSS:" && status >> kb) return kb;
  return 0;
}

/// Hours of a session, on a link that loses, scatters and reorders; each hour the network is gone for 2 s,
/// the server begins anew, and the client's machine sleeps for 20 s.
Json night(int hours) {
  Bench bench(kScene, kClient);
  const auto hand = bench.hand();
  client::Pipeline pipeline = bench.pipeline();
  protocol::LinkConditions link = one_way({.loss = 0.01, .delay = 0.02, .jitter = 0.004, .reordered = 0.01});
  for (int hour = 0; hour < hours; ++hour)
    link.partitions.push_back({from_seconds(3600.0 * hour + 901), from_seconds(3600.0 * hour + 903)});
  test::LinkedPair pair(*hand, pipeline, bench.served(),
                        {.haptic_hz = kHaptic, .sim_hz = kServed, .up = link, .down = link});
  Json rows = Json::array();
  std::uint64_t ticks = 0;
  for (int hour = 0; hour < hours; ++hour) {
    std::vector<Vec3> rendered;  // of this hour, by tick
    const std::uint64_t first = ticks;
    double most = 0, steepest = 0;
    const std::uint64_t samples = pipeline.stats().samples;
    for (int second = 0; second < 3600; ++second) {
      if (second == 1800) pair.restart_server();
      if (second == 2700) pair.suspend(20, false);
      for (int tick = 0; tick < static_cast<int>(kHaptic); ++tick) {
        const Vec3 f_D = pair.tick().f_D;
        most = std::max(most, f_D.norm());
        if (!rendered.empty()) steepest = std::max(steepest, kHaptic * (f_D - rendered.back()).norm());
        rendered.push_back(f_D);
      }
    }
    Errors errors;
    for (const auto& [tick, right] : bench.take_answered())
      if (tick > first && tick - first <= rendered.size()) errors.add(rendered[tick - first - 1], right);
    ticks += rendered.size();
    rows.push_back({{"hour", hour + 1},
                    {"samples_a_second", static_cast<double>(pipeline.stats().samples - samples) / 3620},
                    {"error_percent", errors.percent()},
                    {"largest_newton", most},
                    {"steepest_newton_s", steepest},
                    {"fault", static_cast<int>(pipeline.limiter().fault())},
                    {"resident_kb", resident_kb()}});
    fmt::print(stderr, "night: {} of {} hours\n", hour + 1, hours);
  }
  return rows;
}

}  // namespace
}  // namespace palpate::studies

int main(int argc, char** argv) {
  using namespace palpate;
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const auto first_is = [&](const char* option, std::size_t count) {
    return arguments.size() == count && arguments[0] == option;
  };
  const bool quick = first_is("--quick", 2), scene = first_is("--scene", 4);
  const bool night = first_is("--night", 3) && std::atoi(arguments[1].c_str()) > 0;
  if (!quick && !night && !scene && (arguments.size() != 1 || arguments[0].starts_with("-"))) {
    fmt::print(
        stderr,
        "usage: link_study [--quick | --night HOURS | --scene SCENE CLIENT] DIR     example: link_study "
        "--night 8 out/night\n");
    return 2;
  }
  try {
    const std::filesystem::path out = arguments.back();
    std::filesystem::create_directories(out);
    using namespace studies;
    const Json rows = night   ? studies::night(std::atoi(arguments[1].c_str()))
                      : scene ? study(conditions_of_scene(), arguments[1], arguments[2])
                              : study(all_conditions(quick), kScene, kClient);
    write_json(out / "summary.json", rows);
  } catch (const Error& e) {
    fmt::print(stderr, "link_study: {}\n", e.what());
    return e.exit_code();
  }
  return 0;
}
