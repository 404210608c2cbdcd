#include "haptic_client/session/link_probe.h"

#include <array>

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;

// A Hello of 284 bytes, the tag of a key (16), and the headers of IPv4 and UDP (28): 328 bytes.
TEST_CASE("link probe: its Hellos take at most 5 % of 256 kbit/s, and are 40 at least in 10 s") {
  std::array<std::byte, protocol::kMaxDatagram> bytes{};
  const std::size_t hello = protocol::encode({}, protocol::Hello{}, bytes);
  CHECK(hello == 284);
  CHECK(8.0 * 328 / to_seconds(LinkProbe::kBetweenHellos) <= 0.05 * 256e3);
  CHECK(10 / to_seconds(LinkProbe::kBetweenHellos) > 40);
}
