// `sim_server mesh info` of meshes that are in order, that are mended, and that are refused.
#include <fstream>

#include "tests/support/catch.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"

using namespace palpate::test;

namespace {

/// The corner tetrahedron, and a node that no tetrahedron uses; then `elements`.
std::string mesh_file(const TemporaryFolder& folder, const std::string& elements) {
  const std::string file = (folder.path() / "mesh.msh").string();
  std::ofstream(file) << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
                      << "$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n9 5 5 5\n$EndNodes\n"
                      << "$Elements\n"
                      << elements << "$EndElements\n";
  return file;
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("mesh info of the shipped liver: no faults, exit 0") {
  Process process("sim_server",
                  {"mesh", "info", std::string(PALPATE_SOURCE_DIR) + "/configs/meshes/liver.msh"});
  CHECK(process.wait() == 0);
  CHECK(has(process.output(), "faults              none"));
}

TEST_CASE("mesh info tells what is mended, exit 0") {
  const TemporaryFolder folder;
  Process process("sim_server", {"mesh", "info", mesh_file(folder, "1\n1 4 0 1 2 3 4\n")});
  CHECK(process.wait() == 0);
  const std::string& said = process.output();
  CAPTURE(said);
  CHECK(has(said, "  mended              unused vertices (1): vertex 4 of all, at (5, 5, 5)"));
  CHECK(has(said, "  tetrahedra          1\n"));
  CHECK(has(said, "  volume              0.166667 m3"));
}

TEST_CASE("mesh info lists all faults of a mesh that is refused, says the first on stderr, exit 2") {
  const TemporaryFolder folder;
  const std::string file = mesh_file(folder, "3\n1 4 0 1 3 2 4\n2 4 0 1 2 3 3\n3 4 0 4 1 2 4\n");
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
