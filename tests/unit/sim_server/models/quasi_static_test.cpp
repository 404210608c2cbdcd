// Pre-computed compliance of every linear tissue.
#include "sim_server/models/quasi_static.h"

#include <fmt/format.h>

#include "common/error.h"
#include "sim_server/mesh/shapes.h"
#include "sim_server/scene_file/read_scene.h"
#include "tests/support/catch.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/scenes.h"
#include "tests/support/stiffness.h"
#include "tests/support/temporary_folder.h"

#ifdef PALPATE_WITH_TBB
#include <oneapi/tbb/global_control.h>
#endif

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr std::array kElements{ElementKind::kLinear, ElementKind::kNodalPressure, ElementKind::kQuadratic};

/// A block held where x = 0, all of its surface in reach, with the model on it.
struct Bench {
  TetMesh mesh;
  Surface surface = boundary_surface(mesh);
  Scene scene;
  std::vector<int> fixed, reachable;
  std::optional<QuasiStatic> model;

  explicit Bench(const Material& material)
      : mesh(with_nodes(grid_block({0, 0.01, 0.02, 0.03}, {0, 0.01, 0.02}, {0, 0.012, 0.025}),
                        material.element)),
        scene(test::scene_of(material, {Vec3(-1, -1, -1), Vec3(0, 1, 1)}, 0.005)),
        fixed(fixed_vertices(scene, mesh)) {
    for (int v = 0; v < static_cast<int>(surface.vertices.size()); ++v) reachable.push_back(v);
    model.emplace(ModelInputs{scene, mesh, surface, fixed, reachable, [](std::string_view, double) {}});
  }
};

std::string refusal(const std::string& material, const std::string& model) {
  const test::TemporaryFolder folder;
  folder.write("organ.msh", "");
  const auto file = folder.write(
      "scene.toml",
      fmt::format(
          "[mesh]\nfile = \"organ.msh\"\n[[fixed]]\nbox = [[0, 0, 0], [1, 1, 1]]\n[deformation]\n"
          "model = \"{}\"\n[[tool]]\nradius = 0.005\n[material]\nyoung_modulus = 5e3\npoisson_ratio = "
          "0.4\n{}\n",
          model, material));
  try {
    read_scene(file);
  } catch (const Error& e) {
    return std::string(e.what()).substr(file.string().size());
  }
  return "none";
}

}  // namespace

TEST_CASE("quasi-static: every element, with fibres or without, moves as a dense solve of the body says") {
  const ElementKind element = GENERATE(from_range(kElements));
  Material material{8e3, 0.4, 1000, ElasticLaw::kLinear, element};
  if (GENERATE(false, true)) material.fibres = Fibres{Vec3(1, 2, 0).normalized(), 2e4};
  Bench bench(material);
  const Solid solid(bench.mesh, material);
  std::vector<int> held;
  for (int i = 0; i < solid.nodes(); ++i) {
    if (solid.rest()[i][0] == 0) held.push_back(i);
  }
  const FreeDofs dofs(solid.nodes(), held);
  std::vector<VertexLoad> loads;
  Eigen::VectorXd f = Eigen::VectorXd::Zero(dofs.count);
  for (const int vertex : {3, 17, 30}) {
    const int first = dofs.first[bench.surface.vertices[vertex]];
    if (first < 0) continue;
    loads.push_back({vertex, Vec3(0.01, -0.02, 0.003 * vertex)});
    f.segment<3>(first) = loads.back().force;
  }
  REQUIRE(loads.size() > 1);
  const Eigen::VectorXd u = test::solve_definite(test::dense_stiffness(solid, dofs), f);
  const std::span<const Vec3> moved = bench.model->apply(loads);
  for (std::size_t v = 0; v < moved.size(); ++v) {
    const int vertex = bench.surface.vertices[v], first = dofs.first[vertex];
    const Vec3 expected = first < 0 ? Vec3(Vec3::Zero()) : Vec3(u.segment<3>(first));
    CHECK((moved[v] - bench.mesh.vertices[vertex] - expected).norm() < 1e-9 * u.norm());
  }
}

TEST_CASE("quasi-static: a bar with fibres along it, pulled at its end, gets longer by F L / ((E + k) A)") {
  // Without lateral contraction, and pulled as the linear shape functions of its end say.
  const ElementKind element = GENERATE(ElementKind::kLinear, ElementKind::kNodalPressure);
  Bench bench({5e3, 0, 1000, ElasticLaw::kLinear, element, Fibres{Vec3::UnitX(), 2e4}});
  constexpr double kPull = 0.2, kLength = 0.03, kArea = 0.02 * 0.025;
  std::map<int, double> fraction;  // of the force, by surface vertex
  for (const Triangle& t : bench.surface.triangles) {
    const auto at = [&](int corner) { return bench.mesh.vertices[bench.surface.vertices[t[corner]]]; };
    if (at(0)[0] < kLength || at(1)[0] < kLength || at(2)[0] < kLength) continue;
    const double area = 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
    for (const int corner : t) fraction[corner] += area / kArea / 3;
  }
  std::vector<VertexLoad> loads;
  for (const auto& [vertex, part] : fraction) loads.push_back({vertex, part * kPull * Vec3::UnitX()});
  const double longer = kPull * kLength / ((5e3 + 2e4) * kArea);
  const std::span<const Vec3> moved = bench.model->apply(loads);
  for (std::size_t v = 0; v < moved.size(); ++v) {
    const Vec3& rest = bench.mesh.vertices[bench.surface.vertices[v]];
    CHECK((moved[v] - rest - longer * rest[0] / kLength * Vec3::UnitX()).norm() < 1e-12);
  }
}

TEST_CASE("quasi-static: any element of the linear law, what is not linear is refused in one line") {
  const std::string fibres = "[material.fibres]\ndirection = [1, 0, 0]\nmodulus = 2e4";
  for (const std::string& material :
       {std::string("element = \"p1_nodal_pressure\""), std::string("element = \"p2\""), fibres})
    CHECK(refusal(material, "quasi_static") == "none");
  CHECK(refusal("law = \"neo_hookean\"", "quasi_static") ==
        ":9: model \"quasi_static\" is for law \"linear\" and no relaxation; for this material: implicit");
  CHECK(refusal("element = \"p2\"", "tensor_mass") ==
        ":9: model \"tensor_mass\" is for law \"linear\", element \"p1\", no fibres and no relaxation; "
        "for this material: quasi_static, implicit, reduced");
}

#ifdef PALPATE_WITH_TBB
TEST_CASE("quasi-static: compliance has the same bytes with one thread and two") {
  const ElementKind element = GENERATE(ElementKind::kNodalPressure, ElementKind::kQuadratic);
  Eigen::MatrixXd compliance[2];
  for (const std::size_t threads : {1, 2}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    const Bench bench({8e3, 0.45, 1000, ElasticLaw::kLinear, element});
    const auto n = static_cast<int>(bench.reachable.size());
    ContactPatch patch;
    patch.reserve(n, 1);
    bench.model->compliance(bench.reachable, patch);
    compliance[threads - 1] = patch.compliance;
  }
  REQUIRE(compliance[0].norm() > 0);
  // Columns are found by 96 in a task.
  if (element == ElementKind::kQuadratic) REQUIRE(compliance[0].cols() > 3 * 96);
  CHECK(compliance[0] == compliance[1]);
}
#endif
