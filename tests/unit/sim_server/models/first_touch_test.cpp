// The impulse that a ball gives in its first 5 ms on moving tissue, at several rates.
#include <cmath>
#include <vector>

#include "sim_server/mesh/shapes.h"
#include "sim_server/simulation/simulation.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/soft_block.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr double kTouchTime = 0.005, kBallRadius = 0.005;  // s, m

/// Sum of force times period, N s, from the instant at which a ball that sinks at `speed` (m/s) meets the
/// block above (x, 0, z). Forces are held over a period.
double first_impulse(std::string_view model, double rate_hz, double x, double z, double speed) {
  Scene scene = test::shallow_block_scene(model);
  scene.rate_hz = rate_hz;
  Simulation simulation(scene, test::shallow_block());
  const double period = 1 / rate_hz;
  simulation.step(Vec3(x, kBallRadius + 1e-9, z), period);
  double impulse = 0;
  const int periods = static_cast<int>(std::lround(kTouchTime * rate_hz));
  for (int i = 1; i <= periods; ++i) {
    const ToolForce force = simulation.step(Vec3(x, kBallRadius - speed * i * period, z), period);
    CHECK_FALSE(force.flagged);
    impulse += force.force[1] * period;
  }
  return impulse;
}

struct Touch {
  double x, z, speed;  // m, m, m/s
};
// On a face, on a node, on an edge; and faster, and slower.
const std::vector<Touch> kTouches{
    {0.001, 0.002, 0.1}, {0, 0, 0.1}, {0.002, 0.002, 0.1}, {0.001, 0.002, 0.3}, {0.001, 0.002, 0.03}};

}  // namespace

TEST_CASE("first touch: the impulse on tensor_mass does not depend on the rate, and is that on implicit") {
  // The peak is not asserted: it is a known flaw. The nodes that the ball meets have a mass and reach its
  // speed within one period, so the first force grows as the rate, on tensor_mass and on implicit. On a face
  // at 0.1 m/s on tensor_mass the peak is 0.057, 0.059, 0.080 and 0.150 N at 2, 4, 8 and 16 kHz, where the
  // force after 5 ms is 0.06 N. The impulse there is 0.1929, 0.1929, 0.1906 and 0.1895 mN s.
  for (const Touch& t : kTouches) {
    const auto impulse = [&](std::string_view model, double rate_hz) {
      return first_impulse(model, rate_hz, t.x, t.z, t.speed);
    };
    const double slow = impulse("tensor_mass", 2000), quick = impulse("tensor_mass", 8000);
    CAPTURE(t.x, t.z, t.speed, slow, quick);
    CHECK(slow == Approx(quick).epsilon(0.03));
    CHECK(quick == Approx(impulse("implicit", 8000)).epsilon(0.03));
  }
}

TEST_CASE("first touch: the impulse on reduced follows the rate to first order, near that on tensor_mass") {
  // Forces are those at the end of a period, so a force that rises is held half a period too early: 4.8 %
  // more at 2 than at 8 kHz on a face. Without that error, by extrapolation, the rates agree. The quick modes
  // have no inertia: with 40 modes of some 1450 the impulse is up to a tenth less than on tensor_mass, with
  // 1000 of them 3 %.
  for (const Touch& t : kTouches) {
    const auto impulse = [&](std::string_view model, double rate_hz) {
      return first_impulse(model, rate_hz, t.x, t.z, t.speed);
    };
    const double slow = impulse("reduced", 2000), middle = impulse("reduced", 4000),
                 quick = impulse("reduced", 8000);
    CAPTURE(t.x, t.z, t.speed, slow, middle, quick);
    CHECK((slow - middle) / (middle - quick) == Approx(2).epsilon(0.1));
    CHECK(2 * middle - slow == Approx(2 * quick - middle).epsilon(0.03));
    const double lacks = 1 - quick / impulse("tensor_mass", 8000);
    CHECK(lacks > 0);
    CHECK(lacks < 0.1);
  }
}
