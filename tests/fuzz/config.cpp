// Any bytes as a scene and as a client file.
#include "haptic_client/session/client_config.h"
#include "sim_server/scene/scene.h"
#include "sim_server/scene_file/read_scene.h"
#include "tests/fuzz/file_fuzzer.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  palpate::test::fuzz_file(data, size, ".toml",
                           [](const std::string& file) { palpate::sim::read_scene(file); });
  return palpate::test::fuzz_file(data, size, ".toml",
                                  [](const std::string& file) { palpate::client::read_client_config(file); });
}
