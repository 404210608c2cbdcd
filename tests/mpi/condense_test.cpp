// `sim_server condense` as `mpirun` starts it: the answers of the built-in path whatever the number of ranks,
// what a rank that dies leaves, and what a second start need not do.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <numeric>

#include "sim_server/mesh/shapes.h"
#include "sim_server/scene_file/read_scene.h"
#include "sim_server/simulation/simulation.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/programs.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tool_inputs.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;
using Catch::Contains;

namespace {

const std::string kScenes = source_dir() + "/configs/scenes/";

std::vector<std::string> arguments_of(int ranks, const std::string& scene, const std::string& folder) {
  return {"--allow-run-as-root",
          "--oversubscribe",
          "-n",
          std::to_string(ranks),
          bin_dir() + "/sim_server",
          "condense",
          scene,
          "--out",
          folder};
}

std::string condense(int ranks, const std::string& scene, const std::string& folder, int expected_code = 0) {
  return output_of(PALPATE_MPIRUN, arguments_of(ranks, scene, folder), expected_code, 100);
}

/// The scene of the paper's liver with another model and other lines put into its tool.
std::string scene_with(const TemporaryFolder& folder, const std::string& model,
                       const std::string& of_tool = "") {
  std::string text = bytes_of(kScenes + "liver_paper.toml");
  const auto put = [&](const std::string& old, const std::string& now) {
    const std::size_t at = text.find(old);
    REQUIRE(at != std::string::npos);
    text.replace(at, old.size(), now);
  };
  put("model = \"quasi_static\"", "model = \"" + model + "\"");
  put("file = \"../meshes/", "file = \"" + source_dir() + "/configs/meshes/");
  put("clients = [\"../clients/", "clients = [\"" + source_dir() + "/configs/clients/");
  put("[[tool]]\n", "[[tool]]\n" + of_tool);
  const std::string file = (folder.path() / "scene.toml").string();
  std::ofstream(file) << text;
  return file;
}

/// What a tool feels that goes down onto a place of the surface.
std::vector<Vec3> forces_of(const Scene& scene, const Condensed* condensed) {
  Simulation simulation(scene, kSilent, nullptr, condensed);
  const Triangle top = simulation.touchable(0).front();
  const Vec3 place = simulation.rest()[top[0]];
  std::vector<Vec3> forces;
  for (int i = 0; i < 12; ++i)
    forces.push_back(step(simulation, place + Vec3(0, 0.008 - 1e-3 * i, 0), {}, 1.0 / 30).force);
  return forces;
}

void check_same_for_any_ranks(const std::string& model) {
  const TemporaryFolder folder;
  const std::string file = scene_with(folder, model);
  const Scene scene = read_scene(file);
  const std::vector<Vec3> expected = forces_of(scene, nullptr);
  for (const int ranks : {1, 2, 4}) {
    CAPTURE(ranks);
    const std::string out = (folder.path() / std::to_string(ranks)).string();
    CHECK_THAT(condense(ranks, file, out), Contains("condensed into"));
    const Condensed condensed(out);
    const std::vector<Vec3> rendered = forces_of(scene, &condensed);
    double largest = 0;
    for (std::size_t i = 0; i < rendered.size(); ++i) {
      CHECK((rendered[i] - expected[i]).norm() <= 1e-8 * expected[i].norm());
      largest = std::max(largest, rendered[i].norm());
    }
    CHECK(largest > 0.01);
  }
}

int files_in(const std::string& folder) {
  const std::filesystem::directory_iterator files(folder);
  return static_cast<int>(std::distance(begin(files), end(files)));
}

/// Of all of the surface.
Eigen::MatrixXd compliance_of(const Simulation& simulation) {
  const int size = static_cast<int>(simulation.rest().size());
  std::vector<int> vertices(static_cast<std::size_t>(size));
  std::iota(vertices.begin(), vertices.end(), 0);
  ContactPatch patch;
  patch.reserve(size, 0);
  patch.free.resize(vertices.size());
  simulation.model().compliance(vertices, patch);
  return patch.compliance.topLeftCorner(3 * size, 3 * size);
}

void write_mesh(const std::filesystem::path& file, const TetMesh& mesh) {
  std::ofstream out(file);
  out.precision(17);
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" << mesh.vertices.size() << "\n";
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3& x = mesh.vertices[v];
    out << v + 1 << " " << x[0] << " " << x[1] << " " << x[2] << "\n";
  }
  out << "$EndNodes\n$Elements\n" << mesh.tetrahedra.size() << "\n";
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    out << t + 1 << " 4 2 1 1";
    for (const int v : mesh.tetrahedra[t]) out << " " << v + 1;
    out << "\n";
  }
  out << "$EndElements\n";
}

/// A plate one cell thick, held along an edge, or its mirror image: the scene.
std::string plate_scene(const TemporaryFolder& folder, bool mirrored) {
  TetMesh plate = grid_block({0, 0.01, 0.02, 0.03, 0.04}, {0, 0.005}, {0, 0.012, 0.02, 0.03});
  for (Vec3& x : plate.vertices) x[0] = (mirrored ? -1 : 1) * (x[0] + 0.2 * x[2]);
  if (mirrored) {
    for (Tetrahedron& t : plate.tetrahedra) std::swap(t[0], t[1]);
  }
  const std::string name = mirrored ? "mirrored" : "plate";
  write_mesh(folder.path() / (name + ".msh"), plate);
  const std::string file = (folder.path() / (name + ".toml")).string();
  std::ofstream(file) << "[mesh]\nfile = \"" << name << ".msh\"\n"
                      << "[deformation]\nmodel = \"quasi_static\"\n"
                      << "[material]\nyoung_modulus = 1e4\npoisson_ratio = 0.4\n"
                      << "[[fixed]]\nbox = [[-1, -1, -0.001], [1, 1, 0.001]]\n[[tool]]\nradius = 0.004\n";
  return file;
}

/// The processes that `mpirun` started.
std::vector<pid_t> ranks_of(const Process& mpirun) {
  const std::string id = std::to_string(mpirun.id());
  std::ifstream children("/proc/" + id + "/task/" + id + "/children");
  std::vector<pid_t> ranks;
  for (pid_t rank = 0; children >> rank;) ranks.push_back(rank);
  return ranks;
}

}  // namespace

TEST_CASE("condense: what is felt is as without it, by 1, 2 and 4 ranks") {
  check_same_for_any_ranks("quasi_static");
}

TEST_CASE("condense: so it is of tissue that swings") {
  check_same_for_any_ranks("reduced");
}

TEST_CASE("condense: so it is of a plate whose nodes are all reached, and its mirror image is another body") {
  const TemporaryFolder folder;
  const std::string file = plate_scene(folder, false), mirrored = plate_scene(folder, true);
  const Scene scene = read_scene(file);
  const Eigen::MatrixXd expected = compliance_of(Simulation(scene, kSilent));
  REQUIRE(expected.norm() > 0);
  for (const int ranks : {1, 2}) {
    const std::string out = (folder.path() / std::to_string(ranks)).string();
    condense(ranks, file, out);
    const Condensed condensed(out);
    CHECK((compliance_of(Simulation(scene, kSilent, nullptr, &condensed)) - expected).norm() <=
          1e-9 * expected.norm());
    CHECK_THROWS_WITH(Simulation(read_scene(mirrored), kSilent, nullptr, &condensed),
                      Contains("holds no compliance"));
  }
}

TEST_CASE("condense: a second start finds what there is, and factors nothing") {
  const TemporaryFolder folder;
  const std::string file = scene_with(folder, "quasi_static"), out = (folder.path() / "out").string();
  CHECK_THAT(condense(2, file, out), Contains("its memory, by rank"));
  CHECK_THAT(condense(2, file, out), !Contains("its memory, by rank"));
  CHECK(files_in(out) == 1);
}

TEST_CASE("condense: `explain` tells of a body as it was condensed, and builds nothing beyond that") {
  const TemporaryFolder folder;
  const std::string reach = "reach = [[0.0, 0.03, 0.03], [0.006, 0.06, 0.06]]\n";
  const std::string file = scene_with(folder, "quasi_static", reach), out = (folder.path() / "out").string();
  condense(1, file, out);
  const std::string published =
      output_of("sim_server", {"explain", file, "--no-cache", "--condensed", out, "--steps", "3"}, 0);
  CHECK_THAT(published, Contains("which saved"));                   // by the scene's own compliance
  CHECK_THAT(published, Contains("cannot be built: --condensed"));  // the surface out of reach
  CHECK_THAT(output_of("sim_server", {"explain", kScenes + "liver_tensor_mass.toml", "--condensed", out}, 2),
             Contains("leave it out"));
}

TEST_CASE("condense: a rank that dies ends all within 10 s, and leaves nothing half-written") {
  const int killed = GENERATE(0, 1);
  const TemporaryFolder folder;
  const std::string out = (folder.path() / "out").string();
  Process mpirun(PALPATE_MPIRUN, arguments_of(2, kScenes + "liver.toml", out));
  REQUIRE(mpirun.wait_for("of them kept", 60));  // it is factoring
  const std::vector<pid_t> ranks = ranks_of(mpirun);
  REQUIRE(ranks.size() == 2);
  kill(ranks[static_cast<std::size_t>(killed)], SIGKILL);
  CHECK(mpirun.wait(10) != 0);
  CHECK(files_in(out) == 0);
}

TEST_CASE("condense: wrong input ends all ranks with one line and code 2") {
  const TemporaryFolder folder;
  const std::string out = (folder.path() / "out").string();
  CHECK_THAT(condense(2, kScenes + "liver_tensor_mass.toml", out, 2), Contains("quasi_static, reduced are"));
  CHECK_THAT(condense(2, kScenes + "liver_breathing.toml", out, 2), Contains("supports that move"));
  CHECK_THAT(condense(2, kScenes + "none.toml", out, 2), Contains("none.toml"));
  CHECK_THAT(condense(2, kScenes + "liver.toml", "/dev/null/out", 2), Contains("--out"));
}
