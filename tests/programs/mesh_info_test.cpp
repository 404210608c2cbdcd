// `sim_server mesh info` of meshes that are in order, that are mended, and that are refused.
#include <algorithm>
#include <fstream>

#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;

namespace {

constexpr const char* kCorner = "1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n";

std::string mesh_file(const TemporaryFolder& folder, const std::string& nodes, const std::string& elements) {
  const std::string file = (folder.path() / "mesh.msh").string();
  std::ofstream(file) << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
                      << "$Nodes\n"
                      << std::ranges::count(nodes, '\n') << '\n'
                      << nodes << "$EndNodes\n$Elements\n"
                      << std::ranges::count(elements, '\n') << '\n'
                      << elements << "$EndElements\n";
  return file;
}
/// The corner tetrahedron, and a node that no tetrahedron uses; then `elements`.
std::string mesh_file(const TemporaryFolder& folder, const std::string& elements) {
  return mesh_file(folder, std::string(kCorner) + "9 5 5 5\n", elements);
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("mesh info of the shipped liver: no faults, exit 0") {
  Process process("sim_server", {"mesh", "info", source_dir() + "/configs/meshes/liver_paper.msh"});
  CHECK(process.wait() == 0);
  CHECK(has(process.output(), "faults              none"));
}

TEST_CASE("mesh info tells what is mended, exit 0") {
  const TemporaryFolder folder;
  Process process("sim_server", {"mesh", "info", mesh_file(folder, "1 4 0 1 2 3 4\n")});
  CHECK(process.wait() == 0);
  const std::string& said = process.output();
  CAPTURE(said);
  CHECK(has(said, "  mended              unused vertices (1): vertex 4 of all, at (5, 5, 5)"));
  CHECK(has(said, "  tetrahedra          1\n"));
  CHECK(has(said, "  volume              0.166667 m3"));
}

TEST_CASE("mesh info names the groups of the surface and of the volumes, exit 0") {
  const TemporaryFolder folder;
  const std::string file = mesh_file(folder, "1 4 2 10 1 1 2 3 4\n2 2 2 7 1 1 3 2\n");
  const std::string said = output_of("sim_server", {"mesh", "info", file}, 0);
  CAPTURE(said);
  CHECK(has(said, "  surface_tag         \"7\": 1 triangles\n"));
  CHECK(has(said, "  group of volumes    \"10\": 1 tetrahedra"));
}

TEST_CASE("mesh info lists all faults of a mesh that is refused, says the first on stderr, exit 2") {
  const TemporaryFolder folder;
  const std::string file = mesh_file(folder, "1 4 0 1 3 2 4\n2 4 0 1 2 3 3\n3 4 0 4 1 2 4\n");
  Process process("sim_server", {"mesh", "info", file});
  CHECK(process.wait() == 2);
  const std::string& said = process.output();
  CAPTURE(said);
  CHECK(has(said, "  mended              unused vertices (1)"));
  CHECK(has(said,
            "  refused             inverted tetrahedra (1): tetrahedron 0 (vertices 0 2 1 3) is inverted"));
  CHECK(has(said,
            "  refused             tetrahedra with a vertex twice (2): tetrahedron 1 names vertex 2 twice"));
  CHECK(has(said, "sim_server: error: " + file + ": tetrahedron 0 (vertices 0 2 1 3) is inverted"));
}

TEST_CASE(
    "mesh info: a tetrahedron that is there twice is dropped, vertices in one place are merged, exit 0") {
  const TemporaryFolder folder;
  // The second lies on the slanted face of the first, with three vertices of its own there.
  const std::string file = mesh_file(folder, std::string(kCorner) + "5 1 0 0\n6 0 1 0\n7 0 0 1\n8 1 1 1\n",
                                     "1 4 0 1 2 3 4\n2 4 0 5 6 7 8\n3 4 0 2 3 1 4\n");
  const std::string said = output_of("sim_server", {"mesh", "info", file}, 0);
  CAPTURE(said);
  CHECK(has(said,
            "  mended              repeated tetrahedra (1): tetrahedron 2 of all (vertices 1 2 0 3) is "
            "tetrahedron 0 again; dropped"));
  CHECK(has(said,
            "  mended              vertices where there is one already (3): vertices 1 and 4 are both at"
            " (1, 0, 0)"));
  CHECK(has(said, "  vertices            5\n  edges               9\n  tetrahedra          2\n"));
  CHECK(has(said, "  boundary triangles  6\n  volume              0.5 m3"));
  CHECK_FALSE(has(said, "refused"));
}

TEST_CASE("mesh info: several bodies are refused with their sizes, exit 2") {
  const TemporaryFolder folder;
  const std::string file =
      mesh_file(folder,
                std::string(kCorner) +
                    "5 3 0 0\n6 4 0 0\n7 3 1 0\n8 3 0 1\n9 3 -1 0\n11 6 0 0\n12 7 0 0\n13 6 1 0\n"
                    "14 6 0 1\n",
                "1 4 0 1 2 3 4\n2 4 0 5 6 7 8\n3 4 0 5 9 6 8\n4 4 0 11 12 13 14\n5 4 0 1 2 3 4\n");
  const std::string said = output_of("sim_server", {"mesh", "info", file}, 2);
  const std::string bodies =
      "3 bodies that share no vertex, of 2, 1, 1 tetrahedra, but the organ is one body";
  CAPTURE(said);
  CHECK(has(said, "  mended              repeated tetrahedra (1)"));
  CHECK(has(said, "  refused             bodies (3): " + bodies));
  CHECK(has(said, "sim_server: error: " + file + ": " + bodies));
}

TEST_CASE("mesh info: a body that is there twice, each with vertices of its own, is refused, exit 2") {
  const TemporaryFolder folder;
  const std::string file = mesh_file(folder, std::string(kCorner) + "5 0 0 0\n6 1 0 0\n7 0 1 0\n8 0 0 1\n",
                                     "1 4 0 1 2 3 4\n2 4 0 5 6 7 8\n");
  const std::string said = output_of("sim_server", {"mesh", "info", file}, 2);
  CAPTURE(said);
  CHECK(has(said,
            "  refused             vertices where there is one already (4): vertices 0 and 4 are both at "
            "(0, 0, 0), but cannot be merged: two tetrahedra lie in one place"));
  CHECK(has(said, "sim_server: error: " + file + ": vertices 0 and 4 are both at (0, 0, 0)"));
}

TEST_CASE("mesh info names hinges by their vertices and the worst sliver by its angle, exit 0") {
  const TemporaryFolder folder;
  // The second shares the edge along x with the first, and is flat: atan(0.01) is 0.57 degrees.
  const std::string file =
      mesh_file(folder, std::string(kCorner) + "5 0 -1 0\n6 0 -1 -0.01\n", "1 4 0 1 2 3 4\n2 4 0 1 2 5 6\n");
  const std::string said = output_of("sim_server", {"mesh", "info", file}, 0);
  CAPTURE(said);
  CHECK(has(
      said,
      "  accepted            hinges (1): parts of 1 and 1 tetrahedra are joined by vertices 0 1 alone, at "
      "(0, 0, 0) to (1, 0, 0); one can turn against the other"));
  CHECK(has(said,
            "  accepted            slivers (1): tetrahedron 1 (vertices 0 1 4 5) at (0, 0, 0) has a dihedral"
            " angle of 0.57 degrees, below 1;"));
}
