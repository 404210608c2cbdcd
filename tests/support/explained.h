#pragma once
/// What `sim_server explain` tells of a scene, as JSON.
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

namespace palpate::test {

inline const std::string kSceneFolder = source_dir() + "/configs/scenes/";

/// A liver by some model, without anything that it does not need.
inline std::string minimal(const std::string& model, const std::string& more = "") {
  std::string text = "[mesh]\nfile = \"" + kSceneFolder +
                     "../meshes/liver_paper.msh\"\n[deformation]\nmodel = \"" + model + "\"\n" + more +
                     "[[tool]]\nradius = 0.005\n";
  if (model != "rigid")
    text +=
        "[material]\nyoung_modulus = 1e4\npoisson_ratio = 0.4\n"
        "[[fixed]]\nbox = [[-0.11, -0.08, -0.10], [0.11, 0.10, -0.060]]\n";
  return text;
}

inline nlohmann::json explained(const std::string& scene) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "explain.json").string();
  Process process("sim_server", {"explain", "--no-cache", scene, "--json", file});
  CHECK(process.wait(120) == 0);
  CAPTURE(process.output());
  return read_json(file);
}

}  // namespace palpate::test
