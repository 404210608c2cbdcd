#include "haptic_client/device/usb_lookout.h"

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;
using namespace std::chrono_literals;

TEST_CASE("USB: looked for at first, then when something is plugged in") {
  UsbLookout lookout(true);
  CHECK(lookout.due(0ns));
  lookout.failed(1s, true);
  CHECK_FALSE(lookout.due(1s));
  CHECK_FALSE(lookout.due(10h));
  lookout.poll();
  CHECK(lookout.due(10h));
}

TEST_CASE("USB: a device that cannot be used, or a system that tells nothing: twice a second") {
  for (const auto& [published, absent] : {std::pair(true, false), {false, true}, {false, false}}) {
    CAPTURE(published, absent);
    UsbLookout lookout(published);
    lookout.failed(1s, absent);
    CHECK_FALSE(lookout.due(1499ms));
    CHECK(lookout.due(1500ms));
    lookout.failed(1500ms, absent);
    CHECK_FALSE(lookout.due(1999ms));
    lookout.poll();
    CHECK(lookout.due(1501ms));
  }
}
