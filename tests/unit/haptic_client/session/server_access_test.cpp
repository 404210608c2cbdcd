// What the client says of a network that does not let its datagrams through.
#include "haptic_client/session/server_access.h"

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::client;

TEST_CASE("an error of the network is told with what causes it: nothing there, a firewall, no way") {
  const auto remedy = [](std::errc error) { return remedy_of(std::make_error_code(error)); };
  CHECK_THAT(remedy(std::errc::connection_refused), Catch::Contains("sim_server run"));
  // A firewall of this machine; one that answers "administratively prohibited", by IPv6 and by IPv4.
  CHECK_THAT(remedy(std::errc::operation_not_permitted), Catch::Contains("firewall of this machine"));
  CHECK_THAT(remedy(std::errc::permission_denied), Catch::Contains("firewall on the way"));
  CHECK_THAT(remedy(std::errc::host_unreachable), Catch::Contains("firewall on it or on the way"));
  CHECK_THAT(remedy(std::errc::network_unreachable), Catch::Contains("no way there"));
}
