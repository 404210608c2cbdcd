#ifdef PALPATE_WITH_CAPTURE
#include "sim_server/serving/captured_forces.h"

#include "common/error.h"
#include "tests/support/catch.h"
#include "tests/support/session_capture.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

protocol::ForceSample sample_of(std::uint8_t tool, std::uint64_t number) {
  return {.tool = tool, .number = number, .tool_t_ns = static_cast<std::int64_t>(number) * 10'000'000};
}

}  // namespace

TEST_CASE("captured forces: each session has its own tool, radius and scene, the longest stands first") {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "a.pcap";
  const protocol::ScenePrint one{.mesh = 1}, other{.mesh = 2};
  {
    test::CaptureOf capture(file);
    capture.welcome({.tool = 1, .tool_radius = 0.003, .scene = one}, 7, 5000);
    capture.welcome({.tool = 0, .tool_radius = 0.008, .scene = other}, 3, 6000);
    capture.welcome({.tool = 2, .tool_radius = 0.001, .scene = one}, 4, 7000);  // no sample came
    for (std::uint64_t number = 1; number <= 20; ++number) {
      for (int copies = 0; copies < 2; ++copies) capture.sample(sample_of(1, number), number + 1, 7, 5000);
      if (number <= 10) capture.sample(sample_of(0, number), number + 1, 3, 6000);
    }
    capture.welcome({.tool = 1, .tool_radius = 0.009, .scene = other}, 7, 5000);  // nobody's
    capture.sample(sample_of(4, 1), 1, 9, 8000);  // its Welcome came before the capture began
    capture.close();
  }
  const auto sessions = read_captured_forces(file);
  REQUIRE(sessions.size() == 3);
  CHECK(sessions[0].samples.size() == 20);
  CHECK(sessions[0].tool == 1);
  CHECK(sessions[0].tool_radius == 0.003);
  CHECK(sessions[0].scene == one);
  CHECK(sessions[0].rate_hz() == Approx(100));
  CHECK(sessions[1].samples.size() == 10);
  CHECK(sessions[1].tool == 0);
  CHECK(sessions[1].tool_radius == 0.008);
  CHECK(sessions[1].scene == other);
  CHECK(sessions[2].tool == 4);
  CHECK_FALSE(sessions[2].scene);
}

TEST_CASE("captured forces: a capture without two samples of a session is refused") {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "a.pcap";
  test::CaptureOf capture(file);
  capture.sample(sample_of(0, 1), 1, 7);
  capture.sample(sample_of(0, 1), 1, 8);
  capture.close();
  CHECK_THROWS_WITH(read_captured_forces(file),
                    Catch::Matchers::Contains("holds no force samples of Palpate"));
}
#endif
