#include "sim_server/statics/surface_compliance.h"

#include <numeric>

#include "common/error.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/setup_cache/setup_cache.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

/// What is said of a plate of `side` x `side` cells, one of whose vertices is fixed, with `free` bytes.
std::string refusal(int side, double free, double tolerance) {
  const TetMesh mesh = grid_block(test::lines(0, 1, side), test::lines(0, 1, side), {0, 0.01});
  const Surface surface = boundary_surface(mesh);
  Scene scene = test::scene_of({}, {{-1, -1, -1}, {1, 1, 1}}, 0.01);
  scene.deformation.of<ComplianceTolerance>().relative = tolerance;
  std::vector<int> reachable(surface.vertices.size());
  std::iota(reachable.begin(), reachable.end(), 0);
  const std::vector<int> fixed{0};
  const Progress progress = [](std::string_view, double) {};
  try {
    SurfaceCompliance({scene, mesh, surface, fixed, reachable, progress, free});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("compliance beyond the free memory is refused, with the number of nodes") {
  // 2 x 11 x 11 vertices, one fixed: 241 nodes, (3 241)^2 8 = 4181832 bytes.
  CHECK(refusal(10, 4181832, 0).empty());
  CHECK(
      refusal(10, 4181831, 0) ==
      "test: the compliance of 241 reachable surface nodes would take 4.18 MB, and 4.18 MB are free; give "
      "[[tool]] a `reach` box around the part it touches, or [deformation] a `compliance_tolerance` of 1e-4");
}

TEST_CASE("compliance beyond 4 GB is refused, however much memory is free, where tiles of low rank are not") {
  // 2 x 63 x 63 vertices, one fixed: 7937 nodes, 72 7937^2 = 4.54 GB.
  CHECK(refusal(62, 1e12, 0) ==
        "test: the compliance of 7937 reachable surface nodes would take 4.5 GB, and a scene is given no "
        "more than 4.0 GB for it; give [[tool]] a `reach` box around the part it touches, or [deformation] a "
        "`compliance_tolerance` of 1e-4");
  CHECK(refusal(62, 1e12, 1e-4).empty());
  CHECK(refusal(62, 1e8, 1e-4) ==  // 175 log10(1e4) 7937^1.4 = 202 MB
        "test: the compliance of 7937 reachable surface nodes would take 202 MB, and 100 MB are free; give "
        "[[tool]] a `reach` box around the part it touches");
}

TEST_CASE(
    "compliance is dense for as many as 2000 nodes, and in tiles to 1e-4 for more, if the scene is silent") {
  const ComplianceTolerance silent;
  CHECK(silent.of(2000) == 0);
  CHECK(silent.of(2001) == 1e-4);
  CHECK(ComplianceTolerance{0}.of(1000000) == 0);
  CHECK(ComplianceTolerance{1e-3}.of(3) == 1e-3);
}

TEST_CASE(
    "the tolerance of compliance is read back as it is written, and refused where single precision ends") {
  const test::TemporaryFolder folder;
  const auto read = [&](const std::string& line) {
    const auto file = folder.write("scene.toml", "[deformation]\n" + line + "\n");
    return ComplianceTolerance::read(*Config::read(file).table("deformation"));
  };
  CHECK(read("").to_text().empty());
  CHECK(read("compliance_tolerance = 0").to_text() == "compliance_tolerance = 0\n");
  CHECK(read("compliance_tolerance = 3e-5").to_text() == "compliance_tolerance = 3e-05\n");
  CHECK_THROWS_WITH(
      read("compliance_tolerance = 9e-7"),
      Catch::Matchers::EndsWith("must be 0, for a dense matrix in double precision, or 1e-06 or more"));
  CHECK_THROWS_AS(read("compliance_tolerance = 0.02"), Error);
  CHECK_THROWS_AS(read("compliance_tolerance = -1e-4"), Error);
}

namespace {

/// A plate of 14 x 14 x 1 cells of 1 cm, held at one side: 420 free surface vertices, in tiles of 105.
struct Plate {
  TetMesh mesh = grid_block(test::lines(0, 0.14, 14), test::lines(0, 0.14, 14), {0, 0.01});
  Surface surface = boundary_surface(mesh);
  Scene scene =
      test::scene_of(Material{5e3, 0.4, 1000, ElasticLaw::kLinear}, {{-1, -1, -1}, {0, 1, 1}}, 0.01);
  std::vector<int> fixed = fixed_vertices(scene, mesh), reachable;

  Plate(std::string_view model, double tolerance) {
    scene.deformation.model = model;
    scene.deformation.of<ComplianceTolerance>().relative = tolerance;
    scene.rate_hz = 30;
    reachable.resize(surface.vertices.size());
    std::iota(reachable.begin(), reachable.end(), 0);
  }
  ModelInputs inputs(const SetupCache* cache = nullptr) const {
    static const Progress silent = [](std::string_view, double) {};
    return {scene, mesh, surface, fixed, reachable, silent, 1e12, cache};
  }
  std::unique_ptr<DeformationModel> make(const SetupCache* cache = nullptr) const {
    return model_of(scene.deformation).make(inputs(cache));
  }
};

/// Three loads, one of them on what is held.
std::vector<VertexLoad> loads_on(const Plate& plate) {
  std::vector<VertexLoad> loads;
  for (const Vec3& at : {Vec3(0.14, 0.14, 0.01), Vec3(0.07, 0.02, 0.01), Vec3(0, 0.05, 0.01)}) {
    for (std::size_t v = 0; v < plate.surface.vertices.size(); ++v) {
      if ((plate.mesh.vertices[static_cast<std::size_t>(plate.surface.vertices[v])] - at).norm() < 1e-9)
        loads.push_back({static_cast<int>(v), Vec3(0.01, -0.02, 0.03)});
    }
  }
  return loads;
}

}  // namespace

TEST_CASE(
    "in tiles of low rank every model with such a compliance gives way, and moves, as with a dense one") {
  const std::string model = GENERATE("quasi_static", "tensor_mass", "reduced");
  CAPTURE(model);
  constexpr double kTolerance = 1e-4;
  const Plate plate(model, 0);
  const auto dense = plate.make(), tiled = Plate(model, kTolerance).make();
  const std::vector<VertexLoad> loads = loads_on(plate);
  REQUIRE(loads.size() == 3);
  const auto bytes_of = [](const DeformationModel& of) {
    std::size_t bytes = 0;
    for (const MemoryPart& part : of.memory()) bytes += part.name == "compliance" ? part.bytes : 0;
    return bytes;
  };
  CHECK(bytes_of(*dense) == 1260 * 1260 * sizeof(double));
  CHECK(2 * bytes_of(*tiled) < bytes_of(*dense));

  std::vector<int> vertices;
  for (const VertexLoad& load : loads) vertices.push_back(load.vertex);
  vertices.push_back(vertices[1] + 1);
  ContactPatch a, b;
  for (ContactPatch* const patch : {&a, &b}) {
    patch->reserve(4, 4);
    patch->free.resize(4);
    patch->compliance.shape(12, 12);
  }
  dense->compliance(vertices, a);
  tiled->compliance(vertices, b);
  const Eigen::MatrixXd right = a.compliance.topLeftCorner(12, 12),
                        found = b.compliance.topLeftCorner(12, 12);
  CHECK((found - right).cwiseAbs().maxCoeff() < kTolerance * right(11, 11));  // of one that is free
  CHECK(found == found.transpose());

  for (int step = 0; step < 3; ++step) {
    const double dt = step == 0 ? 0 : 1.0 / 30;
    dense->free_motion(dt);
    tiled->free_motion(dt);
    const auto moved = dense->apply(loads), moved_in_tiles = tiled->apply(loads);
    double most = 0, wrong = 0;
    for (std::size_t v = 0; v < moved.size(); ++v) {
      const Vec3& rest = plate.mesh.vertices[static_cast<std::size_t>(plate.surface.vertices[v])];
      most = std::max(most, (moved[v] - rest).norm());
      wrong = std::max(wrong, (moved[v] - moved_in_tiles[v]).norm());
    }
    CHECK(most > 1e-3);
    CHECK(wrong < kTolerance * most);
    CHECK(wrong > 0);  // it is another matrix
  }
}

TEST_CASE(
    "tiles of low rank come back from the set-up cache bit by bit, and not where others are asked for") {
  const test::TemporaryFolder folder;
  const SetupCache cache(folder.path());
  const Plate plate("quasi_static", 1e-4);
  const std::vector<VertexLoad> loads = loads_on(plate);
  const auto moved = [&](DeformationModel& model) {
    const auto at = model.apply(loads);
    return std::vector<Vec3>(at.begin(), at.end());
  };
  const std::vector<Vec3> first = moved(*plate.make(&cache));
  const auto again = plate.make(&cache);
  CHECK(moved(*again) == first);
  CHECK(again->memory().front().detail.find("from the set-up cache") != std::string::npos);
  CHECK(moved(*plate.make()) == first);
  for (const double tolerance : {0.0, 1e-3}) {
    const auto other = Plate("quasi_static", tolerance).make(&cache);
    CHECK(other->memory().front().detail.find("now in the set-up cache") != std::string::npos);
    CHECK(moved(*other) != first);
  }
}
