#include "protocol/scene_print.h"

#include "tests/support/catch.h"

using namespace palpate::protocol;

TEST_CASE("scene print: stands in the nonce of a server in virtual time, and in that of no other") {
  const ScenePrint print{.mesh = 0x01020304, .material = 0x80000001, .supports = 0xffffffff, .tools = 7};
  Welcome welcome;
  CHECK_FALSE(print_in(welcome, virtual_server()));  // of an older recording
  welcome.server = nonce_of(print);
  CHECK(welcome.server == Nonce{0x0102030480000001, 0xffffffff00000007});
  CHECK(print_in(welcome, virtual_server()) == print);
  CHECK_FALSE(print_in(welcome, {.address = {127, 0, 0, 1}, .port = 45130}));
  CHECK_FALSE(print_in(welcome, virtual_address(1, 45131)));
}

TEST_CASE("scene print: says what differs") {
  const ScenePrint print{.mesh = 1, .material = 2, .supports = 3, .tools = 4};
  ScenePrint other = print;
  CHECK(differences(print, other).empty());
  other.material = 5;
  CHECK(differences(print, other) == "material");
  other = {.mesh = 2, .material = 2, .supports = 9, .tools = 5};
  CHECK(differences(print, other) == "mesh, supports or loads, tools or model");
}
