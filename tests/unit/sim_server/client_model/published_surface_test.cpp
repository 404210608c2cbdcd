// What clients are told of a surface that can be cut.
#include "sim_server/client_model/published_surface.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "sim_server/serving/surface_pager.h"
#include "sim_server/simulation/simulation.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"
#include "tests/support/shaken_block.h"
#include "tests/support/soft_block.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr double kRate = 50;  // Hz

Scene uncut_scene(const char* model) {
  Scene scene = deep_block_scene(model, 0.003);
  scene.rate_hz = kRate;
  return scene;
}
Scene cut_scene(const char* model) {
  Scene scene = uncut_scene(model);
  scene.deformation.of<RayleighDamping>() = {.mass = 40, .stiffness = 1e-4};
  scene.deformation.of<ClientModes>().modes = 20;
  scene.tools[0].cut_buttons = 2;
  scene.cutting = Cutting{.power = 20, .energy = 1e7, .where = "test"};
  if (scene.deformation.model == "hybrid")
    scene.cutting->plan = CutPlan{.point = Vec3::Zero(), .normal = Vec3::UnitX(), .within = 0.011};
  return scene;
}
/// Vertices inside moved at random, by up to so much along each axis (m): some elements are far stiffer than
/// others, and get more mass.
TetMesh stirred_block(double moved) {
  TetMesh mesh = deep_block();
  Random random(7);
  for (Vec3& x : mesh.vertices) {
    const Vec3 by = random.vector(moved);
    if (std::abs(x[0]) < 0.019 && std::abs(x[2]) < 0.019 && x[1] < -0.001 && x[1] > -0.019) x += by;
  }
  return mesh;
}

/// A tool that presses, and whose client wants to know the surface.
struct Published {
  explicit Published(TetMesh mesh, const char* model = "tensor_mass")
      : Published(cut_scene(model), std::move(mesh)) {}
  Published(const Scene& scene, TetMesh mesh) : simulation(scene, std::move(mesh)) {}
  Simulation simulation;
  ToolInput input{.pose = ToolPose(Vec3(0.001, 0.001, 0.0005)), .request = {.surface_shift = true}};

  const ToolAnswer& step() { return simulation.step({&input, 1}, 1 / kRate).front(); }
  const ToolAnswer& continue_(int steps) {
    for (int k = 1; k < steps; ++k) step();
    return step();
  }
};

/// Of these mesh vertices, that are on the surface of both, how each gives way to each; with the told modes.
Eigen::MatrixXd published_compliance(const Simulation& simulation, std::span<const int> nodes) {
  std::vector<int> vertices;
  for (const int node : nodes) vertices.push_back(simulation.resection()->remaining().number_of(node));
  ContactPatch patch;
  patch.reserve(static_cast<int>(vertices.size()), 0);
  patch.free.resize(vertices.size());
  simulation.traits().client->residual_compliance(vertices, patch);
  const auto size = 3 * static_cast<Eigen::Index>(vertices.size());
  Eigen::MatrixXd sum = patch.compliance.topLeftCorner(size, size);
  const PublishedModes& modes = *simulation.published_modes();
  for (Eigen::Index k = 0; k < modes.published; ++k) {
    Eigen::VectorXd shape(size);
    for (std::size_t i = 0; i < vertices.size(); ++i)
      shape.segment<3>(3 * static_cast<Eigen::Index>(i)) = modes.shapes.col(k).segment<3>(3 * vertices[i]);
    sum += shape * shape.transpose() / (modes.frequencies[k] * modes.frequencies[k]);
  }
  return sum;
}
/// The same by the static model of a mesh that never was another.
Eigen::MatrixXd static_compliance(const TetMesh& mesh, std::span<const int> nodes) {
  const Simulation still(uncut_scene("quasi_static"), mesh);
  const std::vector<int>& of = still.surface().vertices;
  std::vector<int> vertices;
  for (const int node : nodes)
    vertices.push_back(static_cast<int>(std::ranges::lower_bound(of, node) - of.begin()));
  ContactPatch patch;
  patch.reserve(static_cast<int>(vertices.size()), 0);
  patch.free.resize(vertices.size());
  still.model().compliance(vertices, patch);
  const auto size = 3 * static_cast<Eigen::Index>(vertices.size());
  return patch.compliance.topLeftCorner(size, size);
}

/// Where the told modes, and the loads by the compliance of the rest, have moved the vertices that bear a
/// load, and where these are, from rest, m.
struct Moved {
  Eigen::VectorXd published, is;
};
Moved moved_in(const Published& published, const ToolAnswer& answer) {
  const Simulation& simulation = published.simulation;
  const PublishedModes& modes = *simulation.published_modes();
  std::vector<int> vertices;
  Eigen::VectorXd forces(3 * static_cast<Eigen::Index>(simulation.loads(0).size()));
  for (const VertexLoad& load : simulation.loads(0)) {
    forces.segment<3>(3 * static_cast<Eigen::Index>(vertices.size())) = load.force;
    vertices.push_back(load.vertex);
  }
  ContactPatch patch;
  patch.reserve(static_cast<int>(vertices.size()), 0);
  patch.free.resize(vertices.size());
  simulation.traits().client->residual_compliance(vertices, patch);
  Moved moved{patch.compliance.topLeftCorner(forces.size(), forces.size()) * forces, forces};
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const auto row = 3 * static_cast<Eigen::Index>(i);
    const auto v = static_cast<std::size_t>(vertices[i]);
    moved.published.segment<3>(row) +=
        modes.shapes.middleRows<3>(3 * vertices[i]).leftCols(modes.published) * answer.modes->q;
    moved.is.segment<3>(row) = simulation.positions()[v] - simulation.rest()[v];
  }
  return moved;
}

/// Some tetrahedra below the top, each beside the one before.
std::vector<Removal> some_removed(const TetMesh& mesh) {
  std::vector<Removal> some;
  for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()) && some.size() < 6; ++t) {
    const Vec3 centre = centre_of(mesh, mesh.tetrahedra[static_cast<std::size_t>(t)]);
    if ((centre - Vec3(0.006, -0.002, 0)).norm() < 0.004) some.push_back({1.0, t});
  }
  return some;
}
std::vector<int> top_of(const TetMesh& mesh) {
  std::vector<int> top;
  for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
    const Vec3& x = mesh.vertices[static_cast<std::size_t>(v)];
    if (x[1] > -1e-9 && std::abs(x[2]) < 0.006 && std::abs(x[0]) < 0.011) top.push_back(v);
  }
  return top;
}

}  // namespace

TEST_CASE("a surface that can be cut: where a tool holds still, its modes stand where the loads hold them") {
  // m; the second has 1 % more mass, where it is stiff
  for (const auto& [model, moved] :
       {std::pair("tensor_mass", 0.0), std::pair("tensor_mass", 0.0013), std::pair("hybrid", 0.0013)}) {
    CAPTURE(model, moved);
    Published published(stirred_block(moved), model);
    const ToolAnswer& answer = published.continue_(150);
    REQUIRE(answer.contacts > 0);
    REQUIRE(answer.modes != nullptr);
    const PublishedModes& modes = *published.simulation.published_modes();
    Eigen::VectorXd held = Eigen::VectorXd::Zero(modes.published);
    for (const VertexLoad& load : published.simulation.loads(0))
      held += modes.shapes.middleRows<3>(3 * load.vertex).leftCols(modes.published).transpose() * load.force;
    held.array() /= modes.frequencies.head(modes.published).array().square();
    CHECK((answer.modes->q - held).norm() < 0.02 * held.norm());  // contact in a pit chatters
    CHECK(answer.modes->v.norm() < 0.01 * (answer.modes->q.cwiseProduct(modes.frequencies)).norm());
  }
}

TEST_CASE("a surface that can be cut: it moves to where its told modes and the rest's compliance lead") {
  for (const char* model : {"tensor_mass", "hybrid"}) {
    CAPTURE(model);
    Published published(deep_block(), model);
    int steps = 0;  // it holds still, and what is told begins as it stands
    while (published.step().modes == nullptr && steps < 60) ++steps;
    double off = 0, largest = 0;
    for (int k = 0; k < 90; ++k) {
      published.input.pose =
          ToolPose(Vec3(0.004 * std::sin(0.1 * k), 0.001 - 0.002 * std::sin(0.25 * k), 0.0005));
      const ToolAnswer& answer = published.step();
      const Moved moved = moved_in(published, answer);
      if (k == 0) CHECK((moved.published - moved.is).norm() < 0.02 * moved.is.norm());
      largest = std::max(largest, moved.is.norm());
      off = std::max(off, (moved.published - moved.is).norm());
    }
    CHECK(largest > 0.002);
    CHECK(off < 0.06 * largest);  // contact chatters
  }
}

TEST_CASE("a surface that can be cut: what is told of it, before and after, is a static model's compliance") {
  const TetMesh mesh = deep_block();
  Published published{TetMesh(mesh)};
  const std::vector<Removal> removals = some_removed(mesh);
  REQUIRE(removals.size() == 6);
  published.simulation.set_cut_options({.planned = removals});
  const std::vector<int> nodes = top_of(mesh);
  published.continue_(40);
  const Eigen::MatrixXd entire = published_compliance(published.simulation, nodes);
  const Eigen::MatrixXd right = static_compliance(mesh, nodes);
  CHECK((entire - right).norm() < 1e-6 * right.norm());
  published.continue_(100);
  REQUIRE(published.simulation.resection()->remaining().count() == mesh.tetrahedra.size() - 6);
  TetMesh remaining = mesh;
  keep_tetrahedra(remaining, [&](std::size_t t) {
    return std::ranges::none_of(removals,
                                [&](const Removal& r) { return r.tetrahedron == static_cast<int>(t); });
  });
  const Eigen::MatrixXd cut = published_compliance(published.simulation, nodes),
                        anew = static_compliance(remaining, nodes);
  CHECK((anew - right).norm() > 0.01 * right.norm());
  CHECK((cut - anew).norm() < 1e-6 * anew.norm());
}

TEST_CASE("a surface that can be cut is told no more in the step that cuts it, and anew at a fixed step") {
  const TetMesh mesh = deep_block();
  std::vector<std::uint32_t> versions[2];
  for (int run = 0; run < 2; ++run) {
    Published published{TetMesh(mesh)};
    published.simulation.set_cut_options({.planned = some_removed(mesh)});
    for (int k = 0; k < 120; ++k) {
      const ToolAnswer& answer = published.step();
      CHECK((answer.modes != nullptr) == (published.simulation.published_surface() != nullptr));
      versions[run].push_back(SurfacePager(published.simulation, 0).state().version);
    }
  }
  CHECK(versions[0] == versions[1]);
  const std::vector<std::uint32_t>& v = versions[0];
  REQUIRE(v[48] != 0);  // the 50th step begins at 0.98 s
  CHECK(v[50] == 0);
  // 0.1 s alone, then 0.1 s and what the mesh takes for the body, and for the surface.
  const auto back = std::find_if(v.begin() + 50, v.end(), [](std::uint32_t version) { return version != 0; });
  REQUIRE(back != v.end());
  CHECK(*back != v[48]);
  CHECK(back - (v.begin() + 50) >= 3 * 5);
  CHECK(back - (v.begin() + 50) <= 3 * 5 + 8);
  CHECK(v.back() == *back);
}

TEST_CASE("a surface that can be cut: what a blade has parted is told as a static model's compliance of it") {
  Scene scene = cut_scene("tensor_mass");
  scene.tools[0].blade = Vec3(0, -0.012, 0);
  Published published(scene, shaken_block({8, 4, 8}));
  published.input.buttons = 2;
  for (int k = 0; k <= 60; ++k) {
    published.input.pose = ToolPose(Vec3(-0.022 + 0.02 * k / 60, 0.0025, 0.001));
    published.step();
  }
  published.input.buttons = 0;
  published.continue_(60);
  const Resection& cut = *published.simulation.resection();
  REQUIRE(cut.totals().splits > 3);
  REQUIRE(published.simulation.published_modes() != nullptr);
  const TetMesh& separated = published.simulation.mesh();
  TetMesh remaining;  // without spare vertices
  std::vector<int> number(separated.vertices.size(), -1);
  for (int v = 0; v < static_cast<int>(number.size()); ++v) {
    if (cut.remaining().around(v).empty()) continue;
    number[static_cast<std::size_t>(v)] = static_cast<int>(remaining.vertices.size());
    remaining.vertices.push_back(separated.vertices[static_cast<std::size_t>(v)]);
  }
  for (Tetrahedron t : separated.tetrahedra) {
    for (int& v : t) v = number[static_cast<std::size_t>(v)];
    remaining.tetrahedra.push_back(t);
  }
  REQUIRE(cut.totals().tetrahedra == 0);
  const auto entire = static_cast<int>(shaken_block({8, 4, 8}).vertices.size());
  std::vector<int> nodes, same;  // on the top, beside where the blade went: copies, too
  int copies = 0;
  for (int v = 0; v < static_cast<int>(number.size()); ++v) {
    const Vec3& x = separated.vertices[static_cast<std::size_t>(v)];
    if (x[1] < -0.001 || std::abs(x[2]) > 0.006 || x[0] > 0 || number[static_cast<std::size_t>(v)] < 0)
      continue;
    nodes.push_back(v);
    same.push_back(number[static_cast<std::size_t>(v)]);
    copies += v >= entire ? 1 : 0;
  }
  REQUIRE(copies > 0);
  const Eigen::MatrixXd right = static_compliance(remaining, same);
  CHECK((published_compliance(published.simulation, nodes) - right).norm() < 1e-6 * right.norm());
}

TEST_CASE("a surface that can be cut: of a piece that hangs on nothing nothing is told, nor of its motion") {
  const TetMesh mesh = deep_block();
  for (const char* model : {"tensor_mass", "hybrid"}) {
    CAPTURE(model);
    Scene scene = cut_scene(model);
    scene.cutting->smallest_piece = 0;
    if (scene.cutting->plan)
      scene.cutting->plan = CutPlan{.point = Vec3(0.01, 0, 0), .normal = Vec3::UnitX(), .within = 0.0155};
    Published published(scene, TetMesh(mesh));
    std::vector<Removal> around;  // of a corner of the top: what is between it and the rest
    const auto in_piece = [](const Vec3& x) { return x[0] > 0.0049 && x[1] > -0.0051 && x[2] > 0.0049; };
    const auto in_box = [](const Vec3& x) { return x[0] > -1e-9 && x[1] > -0.0101 && x[2] > -1e-9; };
    for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t) {
      const Vec3 centre = centre_of(mesh, mesh.tetrahedra[static_cast<std::size_t>(t)]);
      if (in_box(centre) && !in_piece(centre)) around.push_back({0.5, t});
    }
    published.simulation.set_cut_options({.planned = around});
    published.input.pose = ToolPose(Vec3(0.004, 0.001, 0.004));
    published.continue_(100);
    const auto surface = published.simulation.published_surface();
    REQUIRE(surface != nullptr);
    REQUIRE(published.simulation.resection()->totals().tetrahedra == around.size());
    const auto of_piece = [&](int vertex) {
      return in_piece(
          mesh.vertices[static_cast<std::size_t>(published.simulation.surface().vertices[vertex])]);
    };
    CHECK(surface->shape.vertices.size() > 50);
    CHECK(std::ranges::none_of(surface->shape.vertices, of_piece));
    CHECK(std::ranges::none_of(surface->compliant.vertices, of_piece));
  }
}

TEST_CASE("a surface that can be cut: cut again while it is looked at, it is told of what is left at last") {
  const TetMesh mesh = deep_block();
  Published published{TetMesh(mesh)};
  std::vector<Removal> removals = some_removed(mesh);
  for (std::size_t k = 0; k < removals.size(); ++k) removals[k].t = 1 + 0.16 * static_cast<double>(k);
  published.simulation.set_cut_options({.planned = removals});
  published.continue_(51);
  for (int k = 51; k < 90; ++k) {  // the last goes at 1.8 s
    CHECK(published.step().modes == nullptr);
  }
  published.continue_(60);
  TetMesh remaining = mesh;
  keep_tetrahedra(remaining, [&](std::size_t t) {
    return std::ranges::none_of(removals,
                                [&](const Removal& r) { return r.tetrahedron == static_cast<int>(t); });
  });
  const std::vector<int> nodes = top_of(mesh);
  const Eigen::MatrixXd right = static_compliance(remaining, nodes);
  CHECK((published_compliance(published.simulation, nodes) - right).norm() < 1e-6 * right.norm());
}

TEST_CASE("a surface that can be cut: compliance follows the tool within one model, its pages come later") {
  Published published(deep_block({24, 4, 24}));  // 1538 vertices on the surface: of 250 it is told
  published.input.pose = ToolPose(Vec3(-0.008, 0.003, 0));
  published.continue_(60);
  SurfacePager at_tool(published.simulation, 0);
  REQUIRE(at_tool.state().version != 0);
  published.input.pose = ToolPose(Vec3(0.004, 0.003, 0));
  published.continue_(60);
  SurfacePager there(published.simulation, 0);
  CHECK(there.state().version == at_tool.state().version);
  REQUIRE(there.pages().count() == at_tool.pages().count());
  std::size_t first = 0, second = 0, both = 0;
  for (std::uint32_t number = at_tool.pages().first_tile(); number < at_tool.pages().spectrum(); ++number) {
    protocol::SurfacePage a, b;
    REQUIRE(at_tool.page(number, a));
    REQUIRE(there.page(number, b));
    const bool in_first = a.page == number, in_second = b.page == number;
    if (!in_first) CHECK(a.page == number + protocol::SurfacePages::kNotYet);
    first += in_first;
    second += in_second;
    both += in_first && in_second;
    if (in_first && in_second) CHECK(a.values == b.values);
  }
  CHECK(first > 400);
  CHECK(second > 400);
  CHECK(both > 20);
  CHECK(both < first);
}

TEST_CASE("a surface that can be cut: who is in a hurry waits for nothing, and is told it later",
          "[threads]") {
  const TetMesh mesh = deep_block();
  Published published{TetMesh(mesh)};
  published.simulation.set_cut_options({.waits_for_background = false});
  const auto published_by_now = [&] { return published.step().modes != nullptr; };
  for (int k = 0; k < 2000 && !published_by_now(); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  CHECK(published_by_now());
}
