// When a Falcon whose encoders stand still is told of, over a transport in memory.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "haptic_client/device/falcon.h"
#include "tests/emulation/falcon.h"
#include "tests/support/catch.h"
#include "tests/support/emulated_port.h"

using namespace palpate;
using namespace palpate::client;

namespace {

/// A homed Falcon in a hand, under a steady force.
struct Rig {
  emulation::Falcon emulated{{.loaded = true, .homed = true}};
  test::EmulatedPort* port = nullptr;
  std::unique_ptr<Falcon> falcon;
  int tick = 0;

  explicit Rig(double frozen_fade = 0) {
    auto own = std::make_unique<test::EmulatedPort>(emulated);
    port = own.get();
    falcon = std::make_unique<Falcon>(std::move(own), std::vector<std::byte>{}, 10000, frozen_fade);
    command("hand place 0 0 0.12");
  }
  void command(const std::string& line) {
    emulation::Words words;
    std::istringstream in(line);
    for (std::string word; in >> word;) words.push_back(word);
    emulated.command(words.front(), {words.begin() + 1, words.end()}, 0);
  }
  /// The largest torque of its motors now, DAC units.
  double torque() {
    double largest = 0;
    for (const int dac : emulated.wished_dac())
      largest = std::max(largest, std::abs(static_cast<double>(dac)));
    return largest;
  }
  /// What it says after so many seconds under `newton`.
  std::string run(double seconds, double newton) {
    for (const int end = tick + static_cast<int>(seconds * 1000); tick < end; ++tick) {
      const Time now = from_seconds(1 + tick * 1e-3);
      port->advance(now);
      falcon->read(now);
      falcon->write({0, 0, newton});
    }
    return falcon->status();
  }
};

const std::string kReady = "Falcon homed: ready";

}  // namespace

TEST_CASE("a Falcon that stands still is told of under force only, and not when a hand trembles") {
  Rig rig;
  CHECK(rig.run(10, 0) == kReady);
  rig.command("hand tremor 0.0001 tremor_rate 9");
  CHECK(rig.run(10, 3) == kReady);
  rig.command("fault freeze");
  CHECK(rig.run(2.9, 3) == kReady);
  CHECK(rig.run(0.3, 3).find("no encoder of the Falcon moved for 3 s") == 0);
  rig.command("fault freeze 0");
  CHECK(rig.run(10, 3).find("no encoder of the Falcon moved for 3 s") == 0);  // said once
}

TEST_CASE("a Falcon whose encoders stand still loses its force where that was asked for, and has it back") {
  Rig rig(2);
  rig.command("hand tremor 0.0001 tremor_rate 9");
  CHECK(rig.run(10, 3) == kReady);
  const double rendered = rig.torque();
  CHECK(rendered > 200);
  rig.command("fault freeze");
  rig.run(1.9, 3);
  CHECK(rig.torque() == Approx(rendered).epsilon(0.1));
  CHECK(rig.run(0.65, 3).find("its force fades until one does") != std::string::npos);
  CHECK(rig.torque() == Approx(0.45 * rendered).epsilon(0.15));  // 0.55 s into a fade of 1 s
  rig.run(5, 3);
  CHECK(rig.torque() == 0);  // and stays away, though nothing pushes any more
  rig.command("fault freeze 0");
  CHECK(rig.run(0.5, 3) == "the Falcon moves again: its force rises");
  CHECK(rig.torque() == Approx(0.5 * rendered).epsilon(0.15));
  rig.run(2, 3);
  CHECK(rig.torque() == Approx(rendered).epsilon(0.1));
}
