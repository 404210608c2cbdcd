#ifdef PALPATE_WITH_CAPTURE
#include "haptic_client/evaluation/captured_hand.h"

#include "tests/support/catch.h"
#include "tests/support/session_capture.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using namespace palpate::client;
using namespace std::chrono_literals;
using protocol::ToolState;

TEST_CASE("a captured hand: its places in their own time, straight between, and still at the end") {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "F.pcap";
  test::CaptureOf capture(file);
  for (std::uint64_t k = 0; k < 4; ++k) {
    ToolState state{.tick = k + 1, .t_ns = 5'000'000'000 + 10'000'000 * static_cast<std::int64_t>(k)};
    state.p_W = {0.01 * static_cast<double>(k * k), 0, 0};
    state.buttons = static_cast<std::uint16_t>(k);
    if (k == 3) state.flags = ToolState::kDeviceLost;
    capture.state(state, k + 1);
  }
  capture.close();
  CapturedSession session(file, 0);
  CapturedHand hand(session);
  CHECK(hand.seconds() == Approx(0.03));
  const auto x_at = [&](Time t) { return hand.read(900s + t).p_D[0]; };
  CHECK(x_at(0ms) == 0);
  CHECK(x_at(4ms) == Approx(0.004));
  CHECK(x_at(15ms) == Approx(0.025));
  CHECK(hand.read(900s + 17ms).buttons == 1);
  CHECK(hand.read(900s + 25ms).p_D[0] == Approx(0.04));  // not towards where nothing is known
  CHECK(hand.read(900s + 25ms).valid);
  CHECK_FALSE(hand.read(900s + 30ms).valid);
  CHECK_FALSE(hand.read(950s).valid);
}
#endif
