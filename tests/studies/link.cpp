/// How a session fares on bad networks, in virtual time: an organ palpated by the hand of its client file,
/// over links that lose, delay, scatter and reorder datagrams; and the same for a night.
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/text.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/session/client_config.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/scene_file/read_scene.h"
#include "sim_server/serving/served_tools.h"
#include "sim_server/serving/surface_pager.h"
#include "sim_server/serving/tool_path.h"
#include "tests/studies/studies.h"
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
  /// The force, N, that an organ which follows the tool at once has for it there: what should be rendered.
  /// Nothing of one that moves by itself.
  std::optional<Vec3> right_at(const protocol::ToolState& tool) {
    if (!right_) return {};
    return right_->step(sim::pose_of(tool), kTicksPerLook / kHaptic).force;
  }
  /// The ticks that the organ answered since the last call, and the force there, N: what should be rendered.
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

/// Rendered forces, tick by tick.
struct Trace {
  std::vector<Vec3> force;        // N
  double most = 0, steepest = 0;  // N, N/s

  void add(const Vec3& f) {
    most = std::max(most, f.norm());
    if (!force.empty()) steepest = std::max(steepest, kHaptic * (f - force.back()).norm());
    force.push_back(f);
  }
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
  Trace rendered;
  rendered.add(Vec3::Zero());
  std::vector<std::pair<std::uint64_t, Vec3>> rights;
  while (pair.seconds() < kEnd) {
    const client::TickResult tick = pair.tick();
    if (rendered.force.size() % kTicksPerLook == 0) {
      if (const auto right = bench.right_at(tick.tool)) rights.emplace_back(rendered.force.size(), *right);
    }
    rendered.add(tick.f_D);
  }
  ForceErrors bad, healed;
  if (rights.empty()) rights = bench.take_answered();
  for (const auto& [tick, right] : rights) {
    const double t = static_cast<double>(tick) / kHaptic;
    if (t > kInitialize && t <= kFaultsEnd) bad.add(rendered.force[tick], right);
    if (t > kHealed) healed.add(rendered.force[tick], right);
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
      {"largest_newton", rendered.most},
      {"steepest_newton_s", rendered.steepest},
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
  for_all(all.size(), "links", [&] {
    return [&](std::size_t k) {
      Bench bench(scene, client);  // anew: tissue may remember
      rows[k] = run(bench, all[k], 1);
    };
  });
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
    Trace rendered;  // of this hour
    const std::uint64_t first = ticks;
    const std::uint64_t samples = pipeline.stats().samples;
    for (int second = 0; second < 3600; ++second) {
      if (second == 1800) pair.restart_server();
      if (second == 2700) pair.suspend(20, false);
      for (int tick = 0; tick < static_cast<int>(kHaptic); ++tick) rendered.add(pair.tick().f_D);
    }
    ForceErrors errors;
    for (const auto& [tick, right] : bench.take_answered())
      if (tick > first && tick - first <= rendered.force.size())
        errors.add(rendered.force[tick - first - 1], right);
    ticks += rendered.force.size();
    rows.push_back({{"hour", hour + 1},
                    {"samples_a_second", static_cast<double>(pipeline.stats().samples - samples) / 3620},
                    {"error_percent", errors.percent()},
                    {"largest_newton", rendered.most},
                    {"steepest_newton_s", rendered.steepest},
                    {"fault", static_cast<int>(pipeline.limiter().fault())},
                    {"resident_kb", resident_kb()}});
    fmt::print(stderr, "night: {} of {} hours\n", hour + 1, hours);
  }
  return rows;
}

}  // namespace

Command link_command() {
  struct Options {
    std::filesystem::path out, client = kClient;
    std::optional<std::filesystem::path> scene;
    std::optional<int> night;
    bool quick = false;
  };
  const auto options = std::make_shared<Options>();
  return {.name = "link",
          .summary = "How a session fares on networks that lose, delay, scatter and reorder datagrams",
          .footer = "Example: studies link out/night --night 8",
          .options = {{"DIR", "Folder for summary.json", &options->out, {.required = true}},
                      quick_option(options->quick),
                      {"--night",
                       "Hours of a session on one link instead",
                       &options->night,
                       {.within = Bounds{1, 1000}}},
                      {"--scene", "Scene of another organ, on six links", &options->scene},
                      {"--client",
                       "Client file of the hand that palpates it",
                       &options->client,
                       {.needs = "--scene"}}},
          .run = [options] {
            std::filesystem::create_directories(options->out);
            write_json(options->out / "summary.json",
                       options->night   ? night(*options->night)
                       : options->scene ? study(conditions_of_scene(), *options->scene, options->client)
                                        : study(all_conditions(options->quick), kScene, kClient));
            return 0;
          }};
}

}  // namespace palpate::studies
