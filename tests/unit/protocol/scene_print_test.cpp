#include "protocol/scene_print.h"

#include "tests/support/catch.h"

using namespace palpate::protocol;

TEST_CASE("scene print: a Welcome has one where its server knows the scene") {
  const ScenePrint print{.mesh = 0x01020304, .material = 0x80000001, .supports = 0xffffffff, .tools = 7};
  CHECK_FALSE(print_in(Welcome{.server = {1, 2}}));
  CHECK(print_in(Welcome{.scene = print}) == print);
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
