// What `sim_server condense` keeps, taken by a set-up that factors nothing. Here the factor is the built-in
// one.
#include "sim_server/setup_cache/condensed.h"

#include <array>
#include <fstream>

#include "common/error.h"
#include "sim_server/client_model/slow_modes.h"
#include "sim_server/simulation/simulation.h"
#include "sim_server/sparse/sparse_cholesky.h"
#include "sim_server/statics/compliance_tolerance.h"
#include "tests/support/catch.h"
#include "tests/support/soft_block.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tool_inputs.h"

using namespace palpate;
using namespace palpate::sim;
using Catch::Contains;

namespace {

constexpr double kStep = 1.0 / 30;
constexpr std::array kCells{4, 2, 4};

/// Makes factors for this use, and counts them.
MakeFactor built_in(int& made, FactorUse expected = FactorUse::kInverse) {
  return [&made, expected](const SparseMatrix& lower, std::span<const int>, FactorUse use,
                           const std::string& where) {
    ++made;
    CHECK(use == expected);
    return std::make_unique<SparseCholesky>(lower, where);
  };
}

std::vector<Vec3> forces_of(Simulation& simulation) {
  std::vector<Vec3> forces;
  for (int i = 0; i < 20; ++i)
    forces.push_back(test::step(simulation, Vec3(0.002, 0.006 - 3e-4 * i, 0.001), {}, kStep).force);
  return forces;
}

void check_taken_as_made(std::string_view model, int entries, std::optional<double> tolerance = {}) {
  const test::TemporaryFolder folder;
  int made = 0;
  Scene scene = test::deep_block_scene(model);
  scene.deformation.of<ComplianceTolerance>().relative = tolerance;
  Simulation fresh(scene, test::deep_block(kCells));
  const std::vector<Vec3> expected = forces_of(fresh);
  REQUIRE(expected.back().norm() > 0.05);
  const bool with_modes = model == "reduced";
  const Condensed making(folder.path(),
                         built_in(made, with_modes ? FactorUse::kInverseAndSolve : FactorUse::kInverse));
  for (int start = 0; start < 2; ++start) {  // the second finds all of it
    Simulation simulation(scene, test::deep_block(kCells), kSilent, nullptr, &making);
    CHECK(made == 1);
    CHECK(forces_of(simulation) == expected);
  }
  const std::filesystem::directory_iterator files(folder.path());
  CHECK(std::distance(begin(files), end(files)) == entries);
  const Condensed taking(folder.path());
  Simulation simulation(scene, test::deep_block(kCells), kSilent, nullptr, &taking);
  CHECK(forces_of(simulation) == expected);
}

void check_refused(const Scene& scene, TetMesh mesh, const Condensed& condensed, const char* part) {
  CHECK_THROWS_WITH(Simulation(scene, std::move(mesh), kSilent, nullptr, &condensed),
                    Contains("holds no") && Contains(part));
}

}  // namespace

TEST_CASE("condensed: a set-up that takes all of it feels as one that computed it") {
  check_taken_as_made("quasi_static", 1);
  check_taken_as_made("quasi_static", 1, 1e-4);  // in tiles of low rank
}

TEST_CASE("condensed: so does one with modes of vibration") {
  check_taken_as_made("reduced", 2);
}

TEST_CASE("condensed: modes that were asked for are not another number of them, nor of another density") {
  const test::TemporaryFolder folder;
  int made = 0;
  Scene scene = test::deep_block_scene("reduced");
  const Condensed making(folder.path(), built_in(made, FactorUse::kInverseAndSolve));
  const Simulation one(scene, test::deep_block(kCells), kSilent, nullptr, &making);
  const Condensed taking(folder.path());
  scene.material->density *= 1.0001;
  check_refused(scene, test::deep_block(kCells), taking, "modes");
}

TEST_CASE("condensed: what was made of another mesh, material, support or reach is refused") {
  const test::TemporaryFolder folder;
  int made = 0;
  const Scene scene = test::deep_block_scene("quasi_static");
  const Condensed making(folder.path(), built_in(made));
  const Simulation one(scene, test::deep_block(kCells), kSilent, nullptr, &making);
  const Condensed taking(folder.path());
  TetMesh moved = test::deep_block(kCells);
  moved.vertices[moved.vertices.size() / 2] += Vec3(1e-6, 0, 0);  // one vertex by 1/10000 of an edge
  check_refused(scene, moved, taking, "compliance");
  check_refused(scene, test::deep_block({4, 2, 5}), taking, "compliance");
  const auto turned = [](const Vec3& signs) {  // of stiffnesses only the signs between axes are others
    TetMesh mesh = test::deep_block(kCells);
    for (Vec3& x : mesh.vertices) x = x.cwiseProduct(signs);
    for (Tetrahedron& t : mesh.tetrahedra) {
      if (signs.prod() < 0) std::swap(t[0], t[1]);
    }
    return mesh;
  };
  check_refused(scene, turned(Vec3(-1, 1, 1)), taking, "compliance");
  check_refused(scene, turned(Vec3(1, 1, -1)), taking, "compliance");
  check_refused(scene, turned(Vec3(-1, 1, -1)), taking, "compliance");
  Scene other = scene;
  other.material->young_modulus *= 1 + 1e-6;
  check_refused(other, test::deep_block(kCells), taking, "compliance");
  other = scene;
  other.tools[0].reach = Box{Vec3(-0.011, -1, -0.011), Vec3(0.011, 1, 0.011)};
  check_refused(other, test::deep_block(kCells), taking, "compliance");
}

TEST_CASE(
    "condensed: a matrix that is spoilt or half-written is refused with its file, by both who takes and who "
    "makes") {
  const test::TemporaryFolder folder;
  int made = 0;
  const Scene scene = test::deep_block_scene("quasi_static");
  const Condensed making(folder.path(), built_in(made));
  { const Simulation one(scene, test::deep_block(kCells), kSilent, nullptr, &making); }
  const std::filesystem::path file = std::filesystem::directory_iterator(folder.path())->path();
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 8);
  const Condensed taking(folder.path());
  for (const Condensed* condensed : {&making, &taking})
    CHECK_THROWS_WITH(Simulation(scene, test::deep_block(kCells), kSilent, nullptr, condensed),
                      Contains(file.filename().string()) && Contains("condense the scene again"));
}

TEST_CASE("condensed: a folder that is not there, or that nothing can be kept in, is refused at once") {
  const test::TemporaryFolder folder;
  int made = 0;
  CHECK_THROWS_WITH(Condensed(folder.path() / "none"), Contains("no folder"));
  std::ofstream(folder.path() / "file") << "x";
  CHECK_THROWS_WITH(Condensed(folder.path() / "file" / "in", built_in(made)), Contains("--out"));
}
