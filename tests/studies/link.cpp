/// How a session fares on bad networks, in virtual time: the liver of 1999 palpated by the hand of its client
/// file, over links that lose, delay, scatter and reorder datagrams; and the same for a night.
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
#include "sim_server/scene_file/read_scene.h"
#include "sim_server/serving/served_tools.h"
#include "sim_server/serving/surface_pager.h"
#include "tests/support/linked_pair.h"

namespace palpate::studies {
namespace {

constexpr double kBegin = 3, kFaultsEnd = 9, kHealed = 11, kEnd = 15;  // s
constexpr int kCompared = 5;                    // ticks between two looks at the right force
constexpr double kHaptic = 1000, kServed = 30;  // Hz

/// One link, the same each way. Shares; s, of the round trip.
struct Conditions {
  double loss = 0, delay = 0, jitter = 0;
  bool bursts = false;  ///< the losses come in bursts of 8 on the mean
  double reordered = 0;
};

protocol::LinkConditions one_way(const Conditions& c) {
  protocol::LinkConditions link{
      .delay = c.delay / 2, .jitter = c.jitter / 2, .reordered = c.reordered, .reorder_delay = 0.04};
  if (!c.bursts) {
    link.loss = c.loss;
  } else if (c.loss > 0) {
    link.burst_end = 1.0 / 8;
    link.burst_begin = link.burst_end * c.loss / (1 - c.loss);  // so that the share in bursts is `loss`
  }
  return link;
}

/// The scene with its hand; one thread.
class Bench {
 public:
  Bench()
      : scene_(sim::read_scene(std::string(PALPATE_SOURCE_DIR) + "/configs/scenes/liver_paper.toml")),
        config_(client::read_client_config(std::string(PALPATE_SOURCE_DIR) +
                                           "/configs/clients/liver_paper.toml")),
        simulation_(scene_),
        tools_(simulation_),
        pager_(simulation_, 0) {}

  std::unique_ptr<client::Device> hand() const { return client::row_of(config_.device).make(config_.device); }
  client::Pipeline pipeline() const {
    return {find_row(client::extrapolators(), config_.method, "method", config_.method_where).make(),
            config_.workspace, config_.device_limits(), config_.passivity, config_.blend};
  }
  /// Steps for whoever comes; his sessions are new ones even where their numbers are not.
  test::Served served() {
    simulation_.lift_tool(0);
    const auto step = [this](std::uint64_t session, const protocol::ToolState& state) {
      std::vector<sim::SessionInput> inputs{{session, state, true}};
      return tools_.step(inputs, 1 / kServed).front().answer;
    };
    return {
        .step = step,
        .page = [this](std::uint32_t number, protocol::SurfacePage& out) { return pager_.page(number, out); },
        .surface_version = pager_.state().version};
  }
  /// What a tool there feels.
  Vec3 right_force(const Vec3& p_W) { return simulation_.linearise(0, p_W, nullptr).force; }
  const client::ClientConfig& config() const { return config_; }

 private:
  sim::Scene scene_;
  client::ClientConfig config_;
  sim::Simulation simulation_;
  sim::ServedTools tools_;
  sim::SurfacePager pager_;
};

/// Of the felt force against the right one where the hand is, relative to the RMS of the right one.
class Errors {
 public:
  void add(const Vec3& felt, const Vec3& right) {
    errors_.push_back((felt - right).norm());
    squares_ += right.squaredNorm();
  }
  Json percent() {
    if (errors_.empty() || !(squares_ > 0)) return nullptr;
    std::ranges::sort(errors_);
    double sum = 0;
    for (const double e : errors_) sum += e;
    const double count = static_cast<double>(errors_.size()), rms = std::sqrt(squares_ / count);
    const auto at = [&](double share) { return errors_[static_cast<std::size_t>(share * (count - 1))]; };
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
  const protocol::LinkConditions link = one_way(c);
  test::LinkedPair pair(*hand, pipeline, bench.served(),
                        {.haptic_hz = kHaptic,
                         .sim_hz = kServed,
                         .up = link,
                         .down = link,
                         .seed = static_cast<std::uint64_t>(seed),
                         .faults_end = kFaultsEnd});
  Errors bad, healed;
  double most = 0, steepest = 0;
  Vec3 before = Vec3::Zero();
  for (int tick = 0; pair.seconds() < kEnd; ++tick) {
    const client::TickResult felt = pair.tick();
    most = std::max(most, felt.f_D.norm());
    steepest = std::max(steepest, kHaptic * (felt.f_D - before).norm());
    before = felt.f_D;
    if (tick % kCompared != 0) continue;
    if (pair.seconds() > kBegin && pair.seconds() <= kFaultsEnd)
      bad.add(felt.f_D, bench.right_force(felt.tool.p_W));
    if (pair.seconds() > kHealed) healed.add(felt.f_D, bench.right_force(felt.tool.p_W));
  }
  const client::PipelineStats& stats = pipeline.stats();
  const bool itself = stats.told > stats.stepped_down;
  return {{"loss_percent", 100 * c.loss},
          {"bursts", c.bursts},
          {"delay_ms", 1e3 * c.delay},
          {"jitter_ms", 1e3 * c.jitter},
          {"reordered_percent", 100 * c.reordered},
          {"welcomed_ms", pair.first_welcome() ? Json(1e3 * *pair.first_welcome()) : Json(nullptr)},
          {"law_itself_ms", itself ? milliseconds(stats.first_itself - stats.first_told) : Json(nullptr)},
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

Json study(bool quick) {
  const std::vector<Conditions> all = all_conditions(quick);
  std::vector<Json> rows(all.size());
  std::atomic<std::size_t> next{0}, done{0};
  {
    std::vector<std::jthread> workers;
    for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i)
      workers.emplace_back([&] {
        Bench bench;
        for (std::size_t k; (k = next++) < all.size();) {
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
  Bench bench;
  const auto hand = bench.hand();
  client::Pipeline pipeline = bench.pipeline();
  protocol::LinkConditions link = one_way({.loss = 0.01, .delay = 0.02, .jitter = 0.004, .reordered = 0.01});
  for (int hour = 0; hour < hours; ++hour)
    link.partitions.push_back({from_seconds(3600.0 * hour + 901), from_seconds(3600.0 * hour + 903)});
  test::LinkedPair pair(*hand, pipeline, bench.served(),
                        {.haptic_hz = kHaptic, .sim_hz = kServed, .up = link, .down = link});
  Json rows = Json::array();
  for (int hour = 0; hour < hours; ++hour) {
    Errors errors;
    double most = 0, steepest = 0;
    Vec3 before = Vec3::Zero();
    const std::uint64_t samples = pipeline.stats().samples;
    for (int second = 0; second < 3600; ++second) {
      if (second == 1800) pair.restart_server();
      if (second == 2700) pair.suspend(20, false);
      for (int tick = 0; tick < static_cast<int>(kHaptic); ++tick) {
        const client::TickResult felt = pair.tick();
        most = std::max(most, felt.f_D.norm());
        if (tick + second > 0) steepest = std::max(steepest, kHaptic * (felt.f_D - before).norm());
        before = felt.f_D;
        if (tick == 0 && second % 10 == 9) errors.add(felt.f_D, bench.right_force(felt.tool.p_W));
      }
    }
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
  const bool quick = arguments.size() == 2 && arguments[0] == "--quick";
  const bool night =
      arguments.size() == 3 && arguments[0] == "--night" && std::atoi(arguments[1].c_str()) > 0;
  if (!quick && !night && (arguments.size() != 1 || arguments[0].starts_with("-"))) {
    fmt::print(
        stderr,
        "usage: link_study [--quick | --night HOURS] DIR     example: link_study --night 8 out/night\n");
    return 2;
  }
  try {
    const std::filesystem::path out = arguments.back();
    std::filesystem::create_directories(out);
    const Json rows = night ? studies::night(std::atoi(arguments[1].c_str())) : studies::study(quick);
    write_json(out / "summary.json", rows);
  } catch (const Error& e) {
    fmt::print(stderr, "link_study: {}\n", e.what());
    return e.exit_code();
  }
  return 0;
}
