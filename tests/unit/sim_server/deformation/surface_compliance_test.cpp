#include "sim_server/deformation/surface_compliance.h"

#include <numeric>

#include "common/error.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

/// What is said of a plate of `side` x `side` cells, one of whose vertices is fixed, with `free` bytes.
std::string refusal(int side, double free) {
  const TetMesh mesh = grid_block(test::lines(0, 1, side), test::lines(0, 1, side), {0, 0.01});
  const Surface surface = boundary_surface(mesh);
  const Scene scene = test::scene_of({}, {{-1, -1, -1}, {1, 1, 1}}, 0.01);
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
  CHECK(refusal(10, 4181832).empty());
  CHECK(refusal(10, 4181831) ==
        "test: the compliance of 241 reachable surface nodes would take 4.18 MB, and 4.18 MB are free; give "
        "[[tool]] a "
        "`reach` box around the part it touches");
}

TEST_CASE("compliance beyond 4 GB is refused, however much memory is free") {
  // 2 x 63 x 63 vertices, one fixed: 7937 nodes, 72 7937^2 = 4.54 GB.
  CHECK(refusal(62, 1e12) ==
        "test: the compliance of 7937 reachable surface nodes would take 4.5 GB, and a scene is given no "
        "more than "
        "4.0 GB for it; give [[tool]] a `reach` box around the part it touches");
}
