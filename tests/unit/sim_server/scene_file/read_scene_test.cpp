#include "sim_server/scene_file/read_scene.h"

#include <cmath>
#include <fmt/format.h>

#include "common/error.h"
#include "sim_server/mesh/gmsh_io.h"
#include "sim_server/mesh/mesh_faults.h"
#include "sim_server/mesh/tet_mesh.h"
#include "sim_server/tissue/rayleigh_damping.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

/// A scene file of five lines, then `deformation` and `tools`; read.
struct SceneFile {
  test::TemporaryFolder folder;
  std::string file;

  explicit SceneFile(const std::string& tools, const std::string& deformation = "model = \"rigid\"\n") {
    folder.write("organ.msh", "");
    file =
        folder
            .write("scene.toml",
                   "[mesh]\nfile = \"organ.msh\"\n[[fixed]]\nbox = [[0, 0, 0], [1, 1, 1]]\n[deformation]\n" +
                       deformation + tools)
            .string();
  }
  std::string error() const {
    try {
      read_scene(file);
    } catch (const Error& e) {
      return e.what();
    }
    return "none";
  }
};

std::string tool_sections(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += fmt::format("[[tool]]\nradius = 0.00{}\n", i + 1);
  return text;
}

}  // namespace

TEST_CASE("a scene has one to eight tools, each with its own radius and reach") {
  const Scene scene = read_scene(
      SceneFile(tool_sections(7) + "[[tool]]\nradius = 0.009\nreach = [[0, 0, 0], [1, 1, 1]]\n").file);
  REQUIRE(scene.tools.size() == 8);
  CHECK(scene.tools[1].shape.radius == 0.002);
  CHECK(scene.tools[7].shape.radius == 0.009);
  CHECK_FALSE(scene.tools[6].reach);
  CHECK(scene.tools[7].reach);
  CHECK(scene.tools[7].where.ends_with("scene.toml:21"));
  CHECK(test::liver_scene().tools.size() == 1);
}

TEST_CASE("a scene without a tool, or with too many, is refused with what to do") {
  const SceneFile none(""), nine(tool_sections(9)), wrong(tool_sections(2) + "radius_m = 1\n");
  CHECK(none.error() == none.file + ":1: a scene needs a [[tool]]; add one with its `radius`");
  CHECK(nine.error() == nine.file + ":23: a scene has at most 8 [[tool]], this one has 9; remove some");
  CHECK(wrong.error().starts_with(wrong.file + ":11: unknown key"));
}

TEST_CASE("a tool slips freely unless the scene gives it friction") {
  CHECK(read_scene(SceneFile(tool_sections(1)).file).tools[0].shape.friction == 0);
  CHECK(read_scene(SceneFile(tool_sections(1) + "friction = 0.3\n").file).tools[0].shape.friction == 0.3);
  const SceneFile implausible(tool_sections(1) + "friction = 30\n");
  CHECK(implausible.error().starts_with(implausible.file + ":9: "));
}

TEST_CASE("a capsule needs a length, a trocar a pivot and a shaft no thicker than the tip") {
  const auto tool = [](const std::string& keys) { return SceneFile("[[tool]]\n" + keys); };
  const Tool capsule =
      read_scene(tool("shape = \"capsule\"\nradius = 0.004\nlength = 0.02\n").file).tools[0].shape;
  CHECK(capsule.length == 0.02);
  CHECK_FALSE(capsule.is_sphere());
  const Tool trocar = read_scene(tool("shape = \"trocar\"\npivot = [0, 0.1, 0]\n").file).tools[0].shape;
  REQUIRE(trocar.trocar);
  CHECK(trocar.trocar->pivot_W == Vec3(0, 0.1, 0));
  CHECK(trocar.trocar->shaft_radius == 0.003);
  const SceneFile thick = tool("shape = \"trocar\"\npivot = [0, 0.1, 0]\nshaft_radius = 0.006\n"),
                  stray = tool("length = 0.02\n"), unknown = tool("shape = \"cone\"\n");
  CHECK(thick.error().starts_with(thick.file + ":10: `shaft_radius`"));
  CHECK(stray.error().starts_with(stray.file + ":8: unknown key"));
  CHECK(unknown.error().starts_with(unknown.file + ":8: unknown shape"));
}

TEST_CASE("only a model that has damping is asked for it") {
  const auto scene = [](const std::string& deformation) { return SceneFile(tool_sections(1), deformation); };
  const auto plain = read_scene(scene("model = \"tensor_mass\"\n").file).deformation;
  CHECK(plain.of<RayleighDamping>().mass == 10);
  CHECK(plain.of<RayleighDamping>().stiffness == 1e-4);
  const std::string damped = "rayleigh_mass = 0\nrayleigh_stiffness = 1e-3\n";
  const auto given = read_scene(scene("model = \"tensor_mass\"\n" + damped).file).deformation;
  CHECK(given.of<RayleighDamping>().mass == 0);
  CHECK(given.of<RayleighDamping>().stiffness == 1e-3);
  const SceneFile none = scene("model = \"quasi_static\"\n" + damped),
                  negative = scene("model = \"tensor_mass\"\nrayleigh_mass = -1\n");
  CHECK(none.error().starts_with(none.file + ":7: unknown key"));
  CHECK(negative.error().starts_with(negative.file + ":7: "));
}

TEST_CASE("clients of a scene: paths beside the scene, which must be there, and are not read") {
  const SceneFile file("[[tool]]\n[session]\nclients = [\"a.toml\", \"b.toml\"]\n");
  file.folder.write("a.toml", "");
  CHECK(file.error().find("b.toml: no such file") != std::string::npos);
  file.folder.write("b.toml", "what is not even TOML");
  const Scene scene = read_scene(file.file);
  REQUIRE(scene.clients.size() == 2);
  CHECK(scene.clients[1].filename() == "b.toml");
  CHECK(read_scene(SceneFile("[[tool]]\n").file).clients.empty());
}

TEST_CASE("scale of a mesh: one in millimetres is used in metres, one of no organ's size is told") {
  const test::TemporaryFolder folder;
  const std::string mesh =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 100 0 0\n3 0 80 0\n4 0 0 60\n$EndNodes\n"
      "$Elements\n1\n1 4 2 0 0 1 2 3 4\n$EndElements\n";
  folder.write("organ.msh", mesh);
  const auto scene_of_scale = [&](const std::string& scale) {
    return read_scene(folder.write("scene.toml", "[mesh]\nfile = \"organ.msh\"\n" + scale +
                                                     "[deformation]\nmodel = \"rigid\"\n[[tool]]\n"));
  };
  const TetMesh scaled = read_mesh_of(scene_of_scale("scale = 0.001\n"));
  CHECK((scaled.vertices[1] - Vec3(0.1, 0, 0)).norm() < 1e-15);
  CHECK(odd_size(scaled).empty());
  // What is said of the file is said in metres, too.
  const double volume = 0.1 * 0.08 * 0.06 / 6;
  CHECK(check_mesh(folder.path() / "organ.msh", 0.001).mesh.vertices == scaled.vertices);
  CHECK(std::abs(describe(scaled).volume - volume) < 1e-12 * volume);
  CHECK(odd_size(read_mesh_of(scene_of_scale(""))).find("scale = 0.001") != std::string::npos);
  CHECK(odd_size(read_mesh_of(scene_of_scale("scale = 1e-5\n"))).find("0.001 m long") != std::string::npos);
  CHECK_THROWS_AS(scene_of_scale("scale = 0\n"), Error);
  CHECK(read_mesh_of(scene_of_scale("refine = 2\n")).tetrahedra.size() == 64);
  // Half of it cuts the longest edge, here between the second and the third corner.
  const TetMesh halves = read_mesh_of(scene_of_scale("refine = 0.5\n"));
  CHECK(halves.tetrahedra.size() == 2);
  CHECK((halves.vertices.at(4) - Vec3(50, 40, 0)).norm() < 1e-12);
  for (const char* wrong : {"refine = 3\n", "refine = 0.7\n", "refine = -1\n"})
    CHECK_THROWS_AS(scene_of_scale(wrong), Error);
}
