#include <array>
#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <span>
#include <vector>

#include "protocol/c_interface/palpate.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;

namespace {

struct Closer {
  void operator()(palpate_scene* scene) const { palpate_scene_close(scene); }
};
using Scene = std::unique_ptr<palpate_scene, Closer>;

Scene open_scene(const std::string& file) {
  palpate_scene* scene = nullptr;
  char error[512];
  const int code = palpate_scene_open(file.c_str(), &scene, error, sizeof error);
  INFO(error);
  REQUIRE(code == PALPATE_OK);
  return Scene(scene);
}

const std::string kConfigs = source_dir() + "/configs/";

template <class Struct = palpate_tool_state>
Struct at(double x, double y, double z) {
  Struct tool{};
  tool.struct_size = sizeof tool;
  tool.position[0] = x, tool.position[1] = y, tool.position[2] = z;
  return tool;
}

/// One step of the block with its tool there.
palpate_force_sample step(const Scene& scene, palpate_tool_state tool, std::uint32_t flags) {
  tool.flags = flags;
  palpate_force_sample sample{};
  sample.struct_size = sizeof sample;
  REQUIRE(palpate_scene_step(scene.get(), &tool, 1, 0.03, &sample, nullptr, 0) == PALPATE_OK);
  return sample;
}

/// As a later release might have them: with more behind what is known today.
struct LaterToolState : palpate_tool_state {
  double more[5] = {1e300, 1e300, 1e300, 1e300, 1e300};
};
struct LaterForceSample : palpate_force_sample {
  double more[3] = {7, 7, 7};
};

}  // namespace

TEST_CASE("c_interface: the tangent of a block is the difference of its forces") {
  const Scene scene = open_scene(kConfigs + "scenes/block.toml");
  constexpr double kDeep = 0.004, kSpacing = 1e-6;  // m: 2 mm deep
  const auto low = step(scene, at(0, kDeep - kSpacing / 2, 0), 0);
  const auto high = step(scene, at(0, kDeep + kSpacing / 2, 0), 0);
  const auto at_tool = step(scene, at(0, kDeep, 0), PALPATE_WANTS_TANGENT);
  CHECK((at_tool.flags & PALPATE_IN_CONTACT) != 0);
  REQUIRE((at_tool.flags & PALPATE_HAS_TANGENT) != 0);
  CHECK((low.flags & PALPATE_HAS_TANGENT) == 0);
  CHECK(at_tool.force[1] > 0.3);
  CHECK(at_tool.normal[1] > 0.9);
  CHECK(at_tool.gap == 0);
  for (int i = 0; i < 3; ++i)
    CHECK(at_tool.tangent[3 * i + 1] == Approx((high.force[i] - low.force[i]) / kSpacing).margin(2));
  CHECK(at_tool.tangent[4] < -100);
  CHECK(at_tool.time_ns == 90'000'000);
  CHECK(at_tool.number == 3);
}

TEST_CASE(
    "c_interface: a tool that is lost, or away, feels nothing, and what it does not know is not asked") {
  const Scene scene = open_scene(kConfigs + "scenes/block.toml");
  CHECK(step(scene, at(0, 0.003, 0), 0).force[1] > 0.5);
  const auto lost = step(scene, at(0, 0.003, 0), PALPATE_LOST);
  CHECK(lost.force[1] == 0);
  CHECK(step(scene, at(std::nan(""), 2e9, 0), PALPATE_LOST).force[1] == 0);
  const auto away = step(scene, at(0, 0.008, 0), PALPATE_WANTS_TANGENT);
  CHECK(away.force[1] == 0);
  CHECK((away.flags & PALPATE_IN_CONTACT) == 0);
  CHECK(away.gap == Approx(0.002).margin(1e-6));
}

TEST_CASE("c_interface: arrays of longer structs are walked by their own size, and what is behind stays") {
  const TemporaryFolder folder;
  const auto file = folder.write("two.toml", fmt::format(R"(
[mesh]
file = "{}meshes/block.msh"
[deformation]
model = "rigid"
stiffness = 500
[[tool]]
radius = 0.006
[[tool]]
radius = 0.006
)",
                                                         kConfigs));
  const Scene scene = open_scene(file.string());
  REQUIRE(palpate_scene_tools(scene.get()) == 2);
  const std::array<LaterToolState, 2> tools{at<LaterToolState>(-0.01, 0.005, 0),
                                            at<LaterToolState>(0.01, 0.004, 0)};
  std::array<LaterForceSample, 2> samples;
  for (auto& sample : samples) sample.struct_size = sizeof sample;
  REQUIRE(palpate_scene_step(scene.get(), tools.data(), 2, 0.03, samples.data(), nullptr, 0) == PALPATE_OK);
  CHECK(samples[0].force[1] == Approx(0.5));  // 500 N/m, 1 mm deep
  CHECK(samples[1].force[1] == Approx(1.0));
  CHECK(samples[1].tool == 1);
  for (const auto& sample : samples) {
    CHECK(sample.struct_size == sizeof sample);
    for (const double x : sample.more) CHECK(x == 7);
  }
}

TEST_CASE("c_interface: tissue in motion refuses a step of another length, and says which it takes") {
  const Scene scene = open_scene(kConfigs + "scenes/liver_reduced.toml");
  palpate_tool_state tool = at(0, 0.5, 0);
  palpate_force_sample sample{};
  sample.struct_size = sizeof sample;
  char error[512];
  const auto step = [&](double dt) {
    return palpate_scene_step(scene.get(), &tool, 1, dt, &sample, error, sizeof error);
  };
  CHECK(step(1.0 / 30) == PALPATE_OK);
  CHECK(step(0.0333333) == PALPATE_OK);  // as a time in ns or ms has it
  CHECK(step(0) == PALPATE_OK);
  for (const double dt : {0.03, 0.001, 0.05}) {
    CHECK(step(dt) == PALPATE_WRONG_INPUT);
    CHECK_THAT(error, Catch::Matchers::Contains("1 / rate_hz = 0.0333333 s"));
  }
}

TEST_CASE("c_interface: tissue at rest takes steps of any length") {
  const Scene scene = open_scene(kConfigs + "scenes/block.toml");
  palpate_tool_state tool = at(0, 0.5, 0);
  palpate_force_sample sample{};
  sample.struct_size = sizeof sample;
  for (const double dt : {0.03, 0.001, 0.5})
    CHECK(palpate_scene_step(scene.get(), &tool, 1, dt, &sample, nullptr, 0) == PALPATE_OK);
}
