// The keys of client files in configs/README.md are those that their reader knows.
#include "haptic_client/session/client_config.h"
#include "tests/support/catch.h"
#include "tests/support/documented_keys.h"

using namespace palpate;
using namespace palpate::client;

TEST_CASE("configs/README.md: the keys of a client file are those that its reader knows") {
  const std::set<std::string> documented = test::documented_keys("client key");
  const test::Sections file{{"", {}},
                            {"[device]", {}},
                            {"[falcon]", {}},
                            {"[spacemouse]", {}},
                            {"[operator]", {}},
                            {"[trajectory]", {"file = \"motion.csv\""}},
                            {"[workspace]", {}},
                            {"[passivity]", {}},
                            {"[limits]", {}}};
  const auto known =
      test::known_keys(file, test::names_in_sources(), [](const auto& path) { read_client_config(path); });
  CHECK(documented.size() > 30);
  CHECK(test::differences(documented, known) == std::vector<std::string>{});
}
