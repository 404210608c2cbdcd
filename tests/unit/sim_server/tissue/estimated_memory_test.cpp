#include "sim_server/tissue/estimated_memory.h"

#include "sim_server/elasticity/solid.h"
#include "sim_server/elasticity/tensors.h"
#include "sim_server/mesh/gmsh_io.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

TetMesh cube() {
  return test::corner_block(Vec3(0.1, 0.1, 0.1), {10, 10, 10});
}

TetMesh liver() {
  return read_mesh(test::source_dir() + "/configs/meshes/liver_paper.msh");
}

MeshCounts counts_of(const TetMesh& mesh) {
  return count_parts(mesh, boundary_surface(mesh));
}

}  // namespace

TEST_CASE("the parts of a mesh are counted without looking for edges") {
  const TetMesh one = grid_block({0, 1}, {0, 1}, {0, 1});
  const MeshCounts counts = counts_of(one);
  CHECK(counts.vertices == 8);
  CHECK(counts.edges == 19);  // 12 of the cube, 6 diagonals of faces, one of the cube
  CHECK(counts.faces == 18);  // 12 of the skin, 6 around the diagonal
  CHECK(counts.tetrahedra == 6);
  CHECK(counts_of(liver()).edges == describe(liver()).edges);
}

TEST_CASE("the estimate of a body's elements is what it holds") {
  const auto element = GENERATE(ElementKind::kLinear, ElementKind::kNodalPressure, ElementKind::kQuadratic);
  const TetMesh mesh = with_nodes(GENERATE(0, 1) == 0 ? cube() : liver(), element);
  const Solid solid(mesh, {.element = element});
  CAPTURE(static_cast<int>(element), solid.bytes());
  // The scratch of a batch is not counted; it does not grow with the mesh.
  const TetMesh tiny = with_nodes(grid_block({0, 1}, {0, 1}, {0, 1}), element);
  const auto held = [](const Solid& body) {
    return static_cast<double>(body.bytes() + Solid::Scratch(body).bytes());
  };
  const double batch = held(Solid(tiny, {.element = element})) - solid_bytes(counts_of(tiny), element);
  CHECK(solid_bytes(counts_of(mesh), element) + batch == Approx(held(solid)).epsilon(1e-3));
}

TEST_CASE("the estimate of a matrix is what it holds") {
  const auto element = GENERATE(ElementKind::kLinear, ElementKind::kNodalPressure, ElementKind::kQuadratic);
  const TetMesh mesh = with_nodes(GENERATE(0, 1) == 0 ? cube() : liver(), element);
  const Solid solid(mesh, {.element = element});
  const auto held = static_cast<double>(solid.stiffness_matrix(FreeDofs(solid.nodes(), {})).bytes());
  const double estimate = matrix_bytes(counts_of(mesh), element);
  CAPTURE(static_cast<int>(element), estimate / held);
  CHECK(estimate >= held * 0.999);
  CHECK(estimate <= held * (element == ElementKind::kNodalPressure ? 1.25 : 1.01));
}

TEST_CASE("the estimate of tensors is what they hold, and the edges they are sorted from") {
  const TetMesh mesh = GENERATE(0, 1) == 0 ? cube() : liver();
  const ElasticTensors tensors(mesh, {}, {});
  CHECK(tensors_bytes(counts_of(mesh)) ==
        Approx(static_cast<double>(tensors.bytes()) + 48. * static_cast<double>(mesh.tetrahedra.size()))
            .epsilon(1e-3));
}
