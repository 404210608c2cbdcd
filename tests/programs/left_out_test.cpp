// What minimal scenes build, by the real program: its parts, and their bytes. Each later feature adds its
// row.
#include <algorithm>
#include <set>

#include "tests/support/explained.h"

using namespace palpate::test;
using Json = nlohmann::json;

namespace {

std::set<std::string> parts_of(const Json& explanation) {
  std::set<std::string> parts;
  for (const Json& row : explanation["built"]) {
    if (row["bytes"].get<long>() > 0) parts.insert(row["part"].get<std::string>());
  }
  return parts;
}

/// And be it for set-up alone.
bool was_built(const Json& explanation, const std::string& part) {
  const Json& rows = explanation["built"];
  return std::ranges::any_of(rows, [&](const Json& row) { return row["part"] == part; });
}

}  // namespace

TEST_CASE("left out: a minimal scene has these parts in memory, and no other") {
  using Parts = std::set<std::string>;
  struct Row {
    std::string model;
    Parts own;
    double most;  // bytes
    std::string keys = {};
  };
  const std::string kPublished = "published motion", kUnpublished = "client_modes = 0\n";
  // Of 1387 vertices (1329 free), 621 on the surface (566 free), 6254 tetrahedra, 7907 edges: the mesh takes
  // 0.15 MB, the contact of one tool without friction 1.43 MB, compliance 72 x 566^2 = 23.1 MB, tensors 72 a
  // vertex and edge, motion 216 a vertex, 40 modes 3 x 8 x 40 of the surface's. Tissue in implicit motion:
  // some 400 a tetrahedron for elements, and its factor. What clients are told of a motion: compliance once
  // more, 40 modes of all vertices.
  const std::vector<Row> rows{
      {"rigid", {"rest_positions"}, 1.7e6},
      {"quasi_static", {"positions", "compliance"}, 24.8e6},
      {"tensor_mass", {"positions", "tensors", "motion", "compliance"}, 26e6, kUnpublished},
      {"implicit", {"positions", "elements", "motion", "compliance"}, 17e6, kUnpublished},
      {"tensor_mass", {"positions", "tensors", "motion", "compliance", kPublished}, 51e6},
      {"implicit", {"positions", "elements", "motion", "compliance", kPublished}, 42e6},
      {"reduced", {"positions", "compliance", "modes"}, 25.5e6},
  };
  const TemporaryFolder folder;
  for (const auto& [model, own, most, keys] : rows) {
    DYNAMIC_SECTION(model << " " << keys) {
      Parts expected = own;
      expected.insert({"mesh", "surface", "contact"});
      if (model != "rigid") expected.insert("material");  // what presses on both kinds of elements told
      const Json explanation = explained(folder.write("scene.toml", minimal(model, keys)).string());
      CHECK(parts_of(explanation) == expected);
      CHECK(explanation["bytes"].get<double>() < most);
      const bool factors = model != "rigid" && (model != "tensor_mass" || keys.empty());
      for (const char* part : {"stiffness matrix", "its factor"})
        CHECK(was_built(explanation, part) == factors);
    }
  }
}

TEST_CASE("explain --why names the line that asks for a part, or leaves it out") {
  const auto why = [](const std::string& part) {
    Process process("sim_server",
                    {"explain", "--no-cache", kSceneFolder + "liver_falcon.toml", "--why", part});
    const int code = process.wait(120);
    return std::pair(code, process.output());
  };
  const auto [built, line] = why("compliance");
  CHECK(built == 0);
  CHECK(line.find("model = \"quasi_static\"") != std::string::npos);
  CHECK(line.find("liver_falcon.toml:22") != std::string::npos);
  const auto [left, out] = why("the surface out of reach");
  CHECK(left == 0);
  CHECK(out.find("[tool.workspace]") != std::string::npos);
  const auto [rests, still] = why("motion (mass, velocities)");
  CHECK(rests == 0);
  CHECK(still.find("model = \"quasi_static\"") != std::string::npos);
  const auto [wrong, known] = why("complience");
  CHECK(wrong == 2);
  CHECK(known.find("compliance") != std::string::npos);
}
