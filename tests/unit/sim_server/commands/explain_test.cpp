#include "sim_server/commands/explain.h"

#include <algorithm>
#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <set>

#include "sim_server/mesh/shapes.h"
#include "sim_server/scene_file/read_scene.h"
#include "sim_server/simulation/element_trial.h"
#include "sim_server/simulation/error_of_force.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr double kTop = 0.03, kReachFrom = 0.029;  // m

/// 80 x 30 x 40 mm, in cells of 10 mm, held at z = 0.
TetMesh shelf() {
  return grid_block(test::lines_by(-0.04, 0.01, 8), test::lines_by(0, 0.01, 3), test::lines_by(0, 0.01, 4));
}

/// The mesh as Gmsh MSH 2.2.
std::string as_gmsh(const TetMesh& mesh) {
  std::string text = fmt::format("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3& x = mesh.vertices[v];
    text += fmt::format("{} {} {} {}\n", v + 1, x[0], x[1], x[2]);
  }
  text += fmt::format("$EndNodes\n$Elements\n{}\n", mesh.tetrahedra.size());
  for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i) {
    const Tetrahedron& t = mesh.tetrahedra[i];
    text += fmt::format("{} 4 2 0 0 {} {} {} {}\n", i + 1, t[0] + 1, t[1] + 1, t[2] + 1, t[3] + 1);
  }
  return text + "$EndElements\n";
}

const std::string kMesh = "title = \"block\"\nrate_hz = 50\n\n[mesh]\nfile = \"block.msh\"\n";
const std::string kFixed = "[[fixed]]  # the side at z = 0\nbox = [[-1, -1, -1], [1, 1, 0.001]]\n";
const std::string kMaterial = "[material]\nyoung_modulus = 1e4\npoisson_ratio = 0.4\n";
const std::string kTool = "[[tool]]\nradius = 0.004\n";
const std::string kReach = "reach = [[-1, 0.029, -1], [1, 1, 1]]\n";

std::string model(const std::string& name) {
  return "\n[deformation]\nmodel = \"" + name + "\"\n";
}

/// A scene file around `shelf()`, explained.
struct Bench {
  test::TemporaryFolder folder;
  std::string text, file;
  Explanation explanation;

  explicit Bench(const std::string& scene, const TetMesh& mesh = shelf()) : text(scene) {
    folder.write("block.msh", as_gmsh(mesh));
    file = folder.write("scene.toml", text).string();
    explanation = explain(read_scene(file));
  }
  /// "FILE:LINE" of the line that begins with `start`.
  std::string line(const std::string& start) const {
    const std::size_t at = ("\n" + text).find("\n" + start);
    REQUIRE(at != std::string::npos);
    return fmt::format("{}:{}", file,
                       1 + std::count(text.begin(), text.begin() + static_cast<long>(at), '\n'));
  }
  const BuiltPart& built(const std::string& part) const {
    for (const BuiltPart& row : explanation.built) {
      if (row.part == part) return row;
    }
    throw std::runtime_error("not built: " + part);
  }
  bool has(const std::string& part) const {
    return std::ranges::any_of(explanation.built, [&](const BuiltPart& row) { return row.part == part; });
  }
  const Omitted* omitted(const std::string& what) const {
    for (const Omitted& row : explanation.omitted) {
      if (row.what.find(what) != std::string::npos) return &row;
    }
    return nullptr;
  }
};

/// Free surface vertices of the block on triangles that come up to `from_y`, by the triangles themselves.
double reachable_free(double from_y) {
  const TetMesh mesh = shelf();
  const Surface surface = boundary_surface(mesh);
  std::set<int> found;
  for (const Triangle& t : surface.triangles) {
    double top = -1;
    for (const int corner : t) top = std::max(top, mesh.vertices[surface.vertices[corner]][1]);
    if (top < from_y) continue;
    for (const int corner : t) {
      if (mesh.vertices[surface.vertices[corner]][2] > 0.001) found.insert(corner);
    }
  }
  return static_cast<double>(found.size());
}

/// What the simulation of a scene holds, but for its compliance.
double other_bytes(const Scene& scene) {
  double sum = 0;
  for (const MemoryPart& part : Simulation(scene).memory()) {
    if (part.name != "compliance") sum += static_cast<double>(part.bytes);
  }
  return sum;
}

}  // namespace

TEST_CASE("explain: what a quasi-static scene with a reach builds, by line, and what it leaves out") {
  const Bench bench(kMesh + kFixed + kMaterial + model("quasi_static") + kTool + kReach);
  const double r = reachable_free(kReachFrom), all = reachable_free(0);
  REQUIRE(r > 30);
  REQUIRE(all > r + 30);

  CHECK(bench.built("mesh").where == bench.line("file = "));
  CHECK(bench.built("surface").where == "always");
  CHECK(bench.built("fixed").where == bench.line("[[fixed]]"));
  CHECK(bench.built("material").where == bench.line("[material]"));
  CHECK(bench.built("stiffness matrix").where == bench.line("model = "));
  CHECK(bench.built("compliance").where == bench.line("model = "));
  CHECK(bench.built("contact").where == bench.line("[[tool]]"));
  CHECK(bench.explanation.scene.rate_where == bench.line("rate_hz"));

  CHECK(static_cast<double>(bench.built("compliance").bytes) == 72 * r * r);
  const TetMesh mesh = shelf();
  CHECK(bench.built("mesh").bytes == 24 * mesh.vertices.size() + 16 * mesh.tetrahedra.size());
  for (const BuiltPart& part : bench.explanation.built) CHECK(part.setup_ms >= 0);

  const Omitted* reach = bench.omitted("out of reach");
  REQUIRE(reach != nullptr);
  CHECK(reach->why == bench.line("reach = "));
  CHECK(reach->note == "measured");
  Scene unbounded = bench.explanation.scene;
  unbounded.tools[0].reach.reset();
  const double others = other_bytes(unbounded) - other_bytes(bench.explanation.scene);
  CHECK(reach->bytes.value() == 72 * (all * all - r * r) + others);
  CHECK(reach->setup_ms.has_value());
  CHECK(reach->step_ms.has_value());

  const Omitted* entire = bench.omitted("other free vertices");
  REQUIRE(entire != nullptr);
  const double free = 9 * 4 * 4;  // of 9 x 4 x 5 vertices, the 9 x 4 at z = 0 are fixed
  CHECK(entire->bytes.value() == 72 * (free * free - r * r));
  CHECK(entire->note.find("computed") == 0);
  CHECK_FALSE(entire->setup_ms.has_value());
}

TEST_CASE("explain: presses on both kinds of elements count to the material's set-up and memory") {
  const std::string tissue = kMesh + kFixed + kMaterial, more = model("quasi_static") + kTool + kReach;
  const Bench linear(tissue + more), quadratic(tissue + "element = \"p2\"\n" + more);
  const auto presses = try_elements(linear.explanation.scene, shelf()).presses.size();
  REQUIRE(presses > 1);
  const BuiltPart& row = linear.built("material");
  CHECK(row.detail.find(fmt::format(", {} presses on", presses)) != std::string::npos);
  CHECK(quadratic.built("material").detail ==
        "kept: the error of the force by the mesh, 0 presses on \"p1\" and \"p2\": they compare \"p1\" with "
        "\"p2\", and this scene does not have \"p1\"; nothing to change");
  // Of each surface vertex at least: where it is at rest, how fine the mesh is, a list of thin sides.
  const double vertices = static_cast<double>(boundary_surface(shelf()).vertices.size());
  CHECK(static_cast<double>(row.bytes) >= (24 + 8 + 24) * vertices);
  CHECK(row.setup_ms > 0);
}

TEST_CASE("explain: without a reach none is left out, elasticity is not left out where it is built") {
  const Bench bench(kMesh + kFixed + kMaterial + model("quasi_static") + kTool);
  const double all = reachable_free(0);
  CHECK(static_cast<double>(bench.built("compliance").bytes) == 72 * all * all);
  CHECK(bench.omitted("reach") == nullptr);
  CHECK(bench.omitted("elasticity") == nullptr);
  CHECK(bench.omitted("recording") != nullptr);
}

TEST_CASE("explain: what a scene in motion builds: tensors with its sub-steps, and compliance") {
  const Bench bench(kMesh + kFixed + kMaterial + model("tensor_mass") + kTool + kReach);
  const double r = reachable_free(kReachFrom);
  CHECK(static_cast<double>(bench.built("compliance").bytes) == 72 * r * r);
  CHECK(bench.built("tensors").where == bench.line("model = "));
  CHECK(bench.built("tensors").bytes > 0);
  CHECK(bench.built("tensors").detail.find("144 vertices, ") == 0);  // of 9 x 4 x 5, without 9 x 4
  CHECK(bench.built("tensors").detail.find(" sub-steps of ") != std::string::npos);
  CHECK(bench.built("material").detail ==
        fmt::format("kept: the error of the force by the mesh, {} presses on \"p1\" and \"p2\"",
                    ErrorOfForce(bench.explanation.scene, Simulation(bench.explanation.scene)).presses()));
  CHECK(bench.omitted("other free vertices") != nullptr);
  CHECK(bench.omitted("elasticity") == nullptr);
  CHECK(bench.explanation.steps.contacts == 200);
}

TEST_CASE("explain: motion at rest, tangents and a tool's tree are left out, by line") {
  const std::string away = "[[tool]]\nradius = 0.005\nreach = [[5, 5, 5], [6, 6, 6]]\n";
  const Bench rests(kMesh + kFixed + kMaterial + model("quasi_static") + kTool + away);
  const Omitted* motion = rests.omitted("motion");
  REQUIRE(motion != nullptr);
  CHECK(motion->why == rests.line("model = "));
  const TetMesh mesh = shelf();
  CHECK(motion->bytes.value() == 224.0 * static_cast<double>(mesh.vertices.size()));
  CHECK(rests.omitted("collision tree of tool 2")->why == rests.line("reach = "));
  CHECK(rests.omitted("collision tree of tool 1") == nullptr);
  CHECK(rests.omitted("tangents")->step_ms.has_value());
  CHECK(rests.omitted("factor of") == nullptr);
  const Bench moves(kMesh + kFixed + kMaterial + model("tensor_mass") + kTool);
  CHECK(moves.omitted("motion") == nullptr);
  CHECK(moves.omitted("factor of the stiffness matrix")->why == moves.line("model = "));
}

TEST_CASE("explain: what cutting keeps is there where something is cut, and left out elsewhere") {
  const std::string scene = kMesh + kFixed + kMaterial + model("tensor_mass") + kTool;
  const Bench without(scene), with(scene + "cut_buttons = 1\n[cutting]\n");
  CHECK(with.omitted("cutting") == nullptr);
  CHECK(with.built("resection").where == with.line("[cutting]"));
  CHECK_THAT(with.built("added mass").detail,
             Catch::Contains("% more mass in motion") && Catch::Contains("added_mass = 0"));
  CHECK(with.built("added mass").where == with.line("model = "));
  REQUIRE(without.omitted("cutting") != nullptr);
  CHECK(without.omitted("cutting")->bytes.value() == static_cast<double>(with.built("resection").bytes));
}

TEST_CASE("explain: friction is left out, and what it would cost is measured, unless a tool has some") {
  const std::string scene = kMesh + kFixed + kMaterial + model("quasi_static") + kTool;
  const Bench without(scene), with(scene + "friction = 0.2\n");
  const Omitted* row = without.omitted("friction");
  REQUIRE(row != nullptr);
  CHECK(row->why == without.line("[[tool]]"));
  CHECK(row->note == "measured");
  CHECK(row->bytes.value() > 0);
  CHECK(with.omitted("friction") == nullptr);
  CHECK(with.built("contact").detail.find("friction 0.2") != std::string::npos);
}

TEST_CASE("explain: a rigid scene leaves elasticity out, measured where it could be built") {
  const Bench bench(kMesh + kFixed + kMaterial + model("rigid") + kTool);
  const double all = reachable_free(0);
  for (const char* part : {"stiffness matrix", "its factor", "compliance"}) CHECK_FALSE(bench.has(part));
  const Omitted* elasticity = bench.omitted("elasticity");
  REQUIRE(elasticity != nullptr);
  CHECK(elasticity->why == bench.line("model = "));
  CHECK(elasticity->note == "measured");
  Scene elastic = bench.explanation.scene;
  elastic.deformation.model = "quasi_static";
  const double others = other_bytes(elastic) - other_bytes(bench.explanation.scene);
  CHECK(elasticity->bytes.value() == 72 * all * all + others);
}

TEST_CASE("explain: what elasticity would need is named where the scene lacks it") {
  const Bench neither(kMesh + model("rigid") + kTool), loose(kMesh + kMaterial + model("rigid") + kTool);
  const Omitted* row = neither.omitted("elasticity");
  REQUIRE(row != nullptr);
  CHECK(row->why == "no [material], no [[fixed]] section");
  CHECK_FALSE(row->bytes.has_value());
  CHECK_FALSE(row->setup_ms.has_value());
  row = loose.omitted("elasticity");
  REQUIRE(row != nullptr);
  CHECK(row->why == "no [[fixed]] section");
  CHECK(loose.built("material").detail == "not used");
}

TEST_CASE("explain: a variant whose compliance would fill 2 GB is computed, not built") {
  const TetMesh plate = grid_block(test::lines_by(0, 0.002, 55), {0, 0.002}, test::lines_by(0, 0.002, 55));
  const Bench bench(kMesh + kFixed + kMaterial + model("quasi_static") + "compliance_tolerance = 0\n" +
                        kTool + "reach = [[0.09, -1, 0.09], [1, 1, 1]]\n",
                    plate);
  const Omitted* reach = bench.omitted("out of reach");
  REQUIRE(reach != nullptr);
  const double all = 56 * 2 * 55;  // every vertex lies on the surface; those at z = 0 are fixed
  CHECK(reach->bytes.value() == 72 * all * all - static_cast<double>(bench.built("compliance").bytes));
  CHECK(reach->note.find("not built: too large") == 0);
  CHECK_FALSE(reach->setup_ms.has_value());
}

TEST_CASE("explain: a variant that cannot be built says why") {
  // One vertex does not hold a body.
  const Bench bench(kMesh + "[[fixed]]\nbox = [[-0.041, -0.001, -0.001], [-0.039, 0.001, 0.001]]\n" +
                    kMaterial + model("rigid") + kTool);
  const Omitted* elasticity = bench.omitted("elasticity");
  REQUIRE(elasticity != nullptr);
  CHECK(elasticity->note.find("cannot be built: ") == 0);
  CHECK(elasticity->note.find("can turn about the one place -0.04,0,0") != std::string::npos);
}

TEST_CASE("explain: steps free and in contact, and the same hash every time") {
  const std::string scene = kMesh + kFixed + kMaterial + model("quasi_static") + kTool + kReach;
  const Bench one(scene), two(scene);
  CHECK(one.explanation.steps.free_ns.count() == 200);
  CHECK(one.explanation.steps.contact_ns.count() == 200);
  CHECK(one.explanation.steps.contacts == 200);
  CHECK(one.explanation.steps.flagged == 0);
  CHECK(one.explanation.state_hash == two.explanation.state_hash);
  CHECK(one.explanation.state_hash != Simulation(one.explanation.scene).state_hash());
}

TEST_CASE(
    "explain: the press is 40 % of the radius deep, on the reachable surface, and the free tool feels "
    "nothing") {
  const Bench bench(kMesh + kFixed + kMaterial + model("quasi_static") + kTool + kReach);
  Simulation simulation(bench.explanation.scene);
  const Press press = find_press(bench.explanation.scene, simulation);
  const Vec3 vertex = press.place - 0.6 * 0.004 * press.normal;
  CHECK(vertex[1] >= kTop - 0.0101);
  CHECK(vertex[2] > 0.001);
  CHECK(simulation.step(press.place + 0.41 * 0.004 * press.normal, 1e-3).force == Vec3::Zero());
  CHECK(simulation.step(press.place, 1e-3).force.norm() > 0.001);
}

TEST_CASE(
    "explain: where presses settle nowhere, as of a sheet pressed through to its support, four are tried") {
  Scene scene =
      test::scene_of({.young_modulus = 1e4, .poisson_ratio = 0.4, .law = ElasticLaw::kStVenantKirchhoff},
                     {Vec3(-1, -1, -1), Vec3(1, 1e-4, 1)}, 0.02);
  scene.deformation.model = "implicit";
  Simulation simulation(scene, test::corner_block({0.03, 0.004, 0.03}, {4, 1, 4}));
  REQUIRE(simulation.touchable(0).size() > 8);
  const Press press = find_press(scene, simulation);
  CHECK(simulation.flagged().inside_out == 4);
  CHECK(press.place[1] == Approx(0.004 + 0.6 * 0.02));
}

TEST_CASE("explain: each of several tools with its radius, what it reaches, and its own contact memory") {
  const std::string second = "[[tool]]  # the second\nradius = 0.003\n";
  const Bench both(kMesh + kFixed + kMaterial + model("quasi_static") + kTool + kReach + second + kReach);
  const BuiltPart &one = both.built("contact of tool 1"), &two = both.built("contact of tool 2");
  CHECK(one.where == both.line("[[tool]]\n"));
  CHECK(two.where == both.line("[[tool]]  # the second"));
  const Bench alone(kMesh + kFixed + kMaterial + model("quasi_static") + kTool + kReach);
  CHECK(one.bytes >= alone.built("contact").bytes);  // the surface that the other pushes is its own, too
  CHECK(two.bytes > 0);
  CHECK(one.detail.starts_with("sphere, radius 4 mm, reaches "));
  CHECK(two.detail.starts_with("sphere, radius 3 mm, reaches "));
  CHECK_FALSE(both.has("contact"));
  const double r = reachable_free(0.029), all = reachable_free(0);
  CHECK(static_cast<double>(both.built("compliance").bytes) == 72 * r * r);
  REQUIRE(both.omitted("out of reach") != nullptr);
  // One that reaches everything: nothing is out of reach.
  const Bench wide(kMesh + kFixed + kMaterial + model("quasi_static") + kTool + kReach + second);
  CHECK(wide.omitted("out of reach") == nullptr);
  CHECK(static_cast<double>(wide.built("compliance").bytes) == 72 * all * all);
}

TEST_CASE("explain: JSON in plain units, a table that says the same") {
  const Bench bench(kMesh + kFixed + kMaterial + model("quasi_static") + kTool + kReach);
  const Json json = to_json(bench.explanation);
  for (const char* key : {"scene", "title", "model", "rate_hz", "rate_where", "possible_rate_hz", "bytes",
                          "setup_ms", "built", "omitted", "free", "contact", "state_hash"}) {
    CHECK(json.contains(key));
  }
  std::size_t sum = 0;
  for (const Json& row : json["built"]) {
    for (const char* key : {"part", "detail", "where", "bytes", "setup_ms"}) CHECK(row.contains(key));
    sum += row["bytes"].get<std::size_t>();
  }
  CHECK(json["bytes"] == sum);
  int vertices = 0, tetrahedra = 0;
  REQUIRE(std::sscanf(json["built"][0]["detail"].get<std::string>().c_str(), "%d vertices, %d tetrahedra",
                      &vertices, &tetrahedra) == 2);
  CHECK(json["bytes_per_tetrahedron"].get<double>() == Approx(static_cast<double>(sum) / tetrahedra));
  for (const Json& row : json["omitted"]) {
    for (const char* key : {"what", "why", "bytes", "setup_ms", "step_ms", "note"}) CHECK(row.contains(key));
  }
  for (const char* which : {"free", "contact"}) {
    CHECK(json[which]["steps"] == 200);
    CHECK(json[which]["step_ms"]["p99"].get<double>() >= 0);
  }
  const std::string text = to_text(bench.explanation);
  CAPTURE(text);
  for (const char* start : {"reach = ", "rate_hz", "file = "})
    CHECK(text.find(bench.line(start)) != std::string::npos);
  CHECK(text.find(fmt::format("{:016x}", bench.explanation.state_hash)) != std::string::npos);
}
