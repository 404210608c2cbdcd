// Files taken for what they are not: each is told apart by what is in it.
#include <sys/stat.h>

#include "haptic_client/session/client_config.h"
#include "protocol/key_file.h"
#include "sim_server/scene_file/read_scene.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using Catch::Matchers::Contains;
using test::source_dir;

TEST_CASE("a scene given to the client, and a client file given to the server, are named") {
  const std::string scene = source_dir() + "/configs/scenes/block.toml",
                    client = source_dir() + "/configs/clients/block.toml";
  CHECK_THROWS_WITH(client::read_client_config(scene), Contains("is a scene, for `sim_server run"));
  CHECK_THROWS_WITH(sim::read_scene(client), Contains("is a client file, for `haptic_client run`"));
  CHECK_NOTHROW(client::read_client_config(client));
}

TEST_CASE("a folder is not said to be missing") {
  CHECK_THROWS_WITH(sim::read_scene(source_dir()), Contains("is a folder"));
  CHECK_THROWS_WITH(client::read_client_config(source_dir()), Contains("is a folder"));
}

TEST_CASE("a key of zeros and a pipe in place of a key file are refused at once") {
  const test::TemporaryFolder folder;
  const auto zeros = folder.write("zeros.key", "palpate-key 1 " + std::string(64, '0') + "\n");
  const auto one = folder.write("one.key", "palpate-key 1 " + std::string(63, '0') + "1\n");
  const auto pipe = folder.path() / "pipe.key";
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  for (const auto& file : {zeros, one}) REQUIRE(chmod(file.c_str(), 0600) == 0);
  CHECK_THROWS_WITH(protocol::read_keys(zeros), Contains("all zeros"));
  CHECK(protocol::read_keys(one).size() == 1);
  CHECK_THROWS_WITH(protocol::read_keys(pipe), Contains("is no file"));
}
