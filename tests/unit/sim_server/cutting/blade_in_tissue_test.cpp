// Blades in tissue that moves: what they part and what is felt of it, in each model that can be cut.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "sim_server/models/implicit.h"
#include "sim_server/simulation/simulation.h"
#include "sim_server/tissue/contact_instants.h"
#include "sim_server/tissue/rayleigh_damping.h"
#include "tests/support/carved.h"
#include "tests/support/catch.h"
#include "tests/support/shaken_block.h"
#include "tests/support/tool_inputs.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr double kStep = 1.0 / 30;  // s
constexpr double kDepth = 0.02;     // m

Scene blade_scene(std::string_view model) {
  Scene scene = soft_block_scene(kDepth, model, ElasticLaw::kLinear, 0.003);
  scene.tools[0].cut_buttons = 1;
  scene.tools[0].blade = Vec3(0, -0.012, 0);
  scene.cutting = Cutting{.where = "test"};
  scene.deformation.of<RayleighDamping>().stiffness = 1e-4;
  return scene;
}

Scene finely_stepped(Scene scene) {
  scene.deformation.of<ContactInstants>().instants = 224;
  return scene;
}

using Solver = DynamicsSettings::Solver;

Scene implicit_scene(ElasticLaw law, Solver solver) {
  Scene scene = blade_scene("implicit");
  scene.material->law = law;
  auto& settings = scene.deformation.of<ImplicitSettings>();
  settings.solver = solver;
  settings.tolerance = 1e-9;
  settings.max_newton = 50;
  return scene;
}

/// Along x over the top, pressed 0.5 mm deep.
ToolAnswer slide_at(Simulation& simulation, double x, bool cuts, double dt = kStep) {
  return step(simulation, Vec3(x, 0.0025, 0.001), {.buttons = static_cast<std::uint16_t>(cuts ? 1 : 0)}, dt);
}

std::unique_ptr<Simulation> separated_along_x(const Scene& scene) {
  auto cut = std::make_unique<Simulation>(scene, shaken_block({8, 4, 8}));
  for (int i = 0; i <= 60; ++i) slide_at(*cut, -0.022 + 0.02 * i / 60, true);
  return cut;
}

/// At rest by and by: the force is that of linear elasticity on what is left as a mesh of its own.
void check_bears_as_never_entire(Simulation& cut) {
  const ResectionTotals& totals = cut.resection()->totals();
  REQUIRE(totals.splits > 3);
  CHECK(totals.tetrahedra == 0);
  Simulation entire(soft_block_scene(kDepth, "quasi_static", ElasticLaw::kLinear, 0.003),
                    part_of(cut.mesh(), [&](int t) { return cut.resection()->remaining().remains(t); }));
  const Vec3 place(-0.008, 0.001, 0.0035);
  ToolAnswer rendered, right;
  for (int i = 0; i < 300; ++i) rendered = step(cut, place, {}, kStep);
  for (int i = 22; i >= 0; --i) right = step(entire, place + Vec3(0, 5e-4 * i, 0), {}, kStep);
  REQUIRE(right.force.norm() > 0.05);
  CHECK((rendered.force - right.force).norm() < 1e-6 * right.force.norm());
}

void check_bears_as_never_entire(const Scene& scene) {
  check_bears_as_never_entire(*separated_along_x(scene));
}

constexpr int kAnything = 600;  // steps

/// A blade and a hot tip on their ways: in how many of `kAnything` steps no answer was found.
std::uint64_t flagged_by_anything(Scene scene, unsigned seed = 2, std::uint64_t most_ran_away = 0) {
  scene.tools[0].reach.reset();
  scene.tools.push_back(scene.tools[0]);
  scene.tools[1].blade.reset();
  scene.cutting->energy = 1e7;
  scene.cutting->power = 3;
  scene.cutting->smallest_piece = 1e-7;
  Simulation simulation(scene, shaken_block({8, 4, 8}));
  std::minstd_rand random(seed);
  const auto anywhere = [&](double most) {
    return most * (2 * static_cast<double>(random()) / std::minstd_rand::max() - 1);
  };
  Vec3 from(0, 0.0025, 0), to = from;
  Quat q_from = Quat::Identity(), q_to = q_from;
  double largest = 0;
  for (int i = 0; i < kAnything; ++i) {
    if (i % 12 == 0) {  // up to 40 mm in 0.4 s
      // In this order by any compiler.
      const double z = anywhere(0.02), y = 0.0022 + anywhere(2e-3), x = anywhere(0.02);
      from = std::exchange(to, Vec3(x, y, z));
      const double axis_y = anywhere(0.1), axis_x = anywhere(1), angle = anywhere(0.6);
      q_from = std::exchange(q_to, Quat(Eigen::AngleAxisd(angle, Vec3(axis_x, axis_y, 1).normalized())));
    }
    const double fraction = (i % 12 + 1) / 12.0;
    std::vector<ToolInput> inputs(2);
    const bool bounces = i / 100 % 2 == 1 && i % 2 == 0;
    inputs[0] = {.pose = ToolPose(Vec3(from + fraction * (to - from)), q_from.slerp(fraction, q_to)),
                 .buttons = static_cast<std::uint16_t>(bounces ? 0 : 1)};
    inputs[1] = {.pose = ToolPose(Vec3(-0.01 + 0.02 * i / kAnything, 0.0025, 0.012)), .buttons = 1};
    for (const ToolAnswer& answer : simulation.step(inputs, kStep))
      largest = std::max(largest, answer.force.norm());
  }
  const ResectionTotals& totals = simulation.resection()->totals();
  CHECK(totals.splits > 50);
  CHECK(totals.tetrahedra > 20);
  CHECK(largest < 20);
  double volume = 0, enclosed = 0;
  const CutMesh& remaining = simulation.resection()->remaining();
  const TetMesh& mesh = simulation.mesh();
  for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t)
    volume += remaining.remains(t) ? six_volumes(mesh, mesh.tetrahedra[t]) / 6 : 0;
  for (const Triangle& t : simulation.surface().triangles) {
    const auto at = [&](int v) { return mesh.vertices[simulation.surface().vertices[v]]; };
    enclosed += at(t[0]).dot(at(t[1]).cross(at(t[2]))) / 6;
  }
  CHECK(enclosed == Approx(volume));
  CHECK(volume == Approx(0.04 * kDepth * 0.04 - totals.volume).epsilon(1e-3));
  const FlaggedSteps& flagged = simulation.flagged();
  CHECK(flagged.threw + flagged.inside_out == 0);
  CHECK(flagged.ran_away <= most_ran_away);
  return flagged.not_balanced + flagged.tools + flagged.contact;
}

/// A half is pulled while a blade cuts it off, then carried away.
void check_halves_part(Scene scene) {
  scene.tools[0].blade = Vec3(0, -0.04, 0);
  scene.tools.push_back(scene.tools[0]);
  scene.tools[1].blade.reset();
  scene.tools[1].cut_buttons = 0;
  scene.tools[1].grasp_buttons = 2;
  scene.fixed[0].box = {Vec3(-1, -1, -1), Vec3(-0.0199, 1, 1)};  // its left side
  Simulation simulation(scene, shaken_block({8, 4, 8}));
  const auto go = [&](double z, const std::optional<Vec3>& pull, bool cuts) {
    std::vector<ToolInput> inputs(2);
    inputs[0] = {.pose = ToolPose(Vec3(0.0011, 0.004, z)),
                 .buttons = static_cast<std::uint16_t>(cuts ? 1 : 0)};
    if (pull) inputs[1] = {.pose = ToolPose(*pull), .buttons = 2};
    return simulation.step(inputs, kStep)[1].force.norm();
  };
  const Vec3 grip(0.012, 0.003, 0);
  for (int i = 0; i < 10; ++i) go(-0.03, grip, false);
  double pulled = 0;
  for (int i = 0; i <= 40; ++i) pulled = go(-0.03, grip + Vec3(1e-4 * i, 0, 0), false);
  REQUIRE(pulled > 0.1);
  for (int i = 0; i <= 90; ++i) go(-0.03 + 0.06 * i / 90, grip + Vec3(4e-3, 0, 0), true);
  CHECK(simulation.resection()->totals().loose_pieces == 1);
  CHECK(simulation.resection()->totals().loose_volume == Approx(0.0189 * kDepth * 0.04).epsilon(0.05));
  double held = 0;
  for (int i = 0; i < 120; ++i) held = go(0.04, grip + Vec3(4e-3 + 1e-4 * i, 0, 0), false);
  CHECK(held < 0.05 * pulled);
}

/// A block of which jaws hold some of the top, lifted by a millimetre, while a blade goes along x between
/// them.
struct HeldWhileCut {
  Simulation simulation;
  explicit HeldWhileCut(const Scene& scene) : simulation(with_jaws(scene), shaken_block({8, 4, 8})) {
    for (int i = 0; i <= 60; ++i) go(-0.025, false, std::min(1.0, i / 30.0));
  }
  static Scene with_jaws(Scene scene) {
    scene.tools[0].blade = Vec3(0, -0.016, 0);
    scene.tools.push_back(scene.tools[0]);
    scene.tools[1].blade.reset();
    scene.tools[1].cut_buttons = 0;
    scene.tools[1].grasp_place = Vec3(0, 0.001, 0.001);
    scene.tools[1].shape.radius = 0.008;
    return scene;
  }
  /// The force on the jaws, N, with the tip of the blade above the tissue.
  Vec3 go(double x, bool cuts, double lifted = 1) {
    std::vector<ToolInput> inputs(2);
    inputs[0] = {.pose = ToolPose(Vec3(x, 0.008, 0.001)),
                 .buttons = static_cast<std::uint16_t>(cuts ? 1 : 0)};
    inputs[1] = {.pose = ToolPose(Vec3(0, 0.001 + 1e-3 * lifted, 0.001))};
    return simulation.step(inputs, kStep)[1].force;
  }
  std::vector<int> held() const {
    const std::span<const int> vertices = simulation.tool(1).held_vertices();
    return {vertices.begin(), vertices.end()};
  }
  /// Area at rest of the top between vertices that are held, m^2.
  double held_area() const {
    double sum = 0;
    const std::vector<int> in_jaws = held();
    for (const Triangle& t : simulation.surface().triangles) {
      const auto at = [&](int v) -> const Vec3& { return simulation.rest()[static_cast<std::size_t>(v)]; };
      const auto counts = [&](int v) { return at(v).y() > -1e-9 && std::ranges::count(in_jaws, v) > 0; };
      if (std::ranges::all_of(t, counts)) sum += (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).norm() / 2;
    }
    return sum;
  }
  /// Vertices of the surface where these are at rest, beside them.
  std::vector<int> copies_of(const std::vector<int>& vertices) const {
    std::vector<int> copies;
    for (int v = 0; v < static_cast<int>(simulation.rest().size()); ++v) {
      const auto is_copy = [&](int of) {
        return v != of && simulation.rest()[static_cast<std::size_t>(v)] ==
                              simulation.rest()[static_cast<std::size_t>(of)];
      };
      if (simulation.resection()->remaining().on_surface(v) && std::ranges::any_of(vertices, is_copy))
        copies.push_back(v);
    }
    return copies;
  }
  /// Strain of what the jaws hold where this vertex is pulled 2 mm out of it; -1: where none is.
  double strain_with(int vertex) const {
    std::vector<Vec3> positions(simulation.positions().begin(), simulation.positions().end());
    if (vertex >= 0) positions[static_cast<std::size_t>(vertex)] += Vec3(0, 2e-3, 0);
    return simulation.tool(1).surface_strain(positions, simulation.rest());
  }
};
}  // namespace

TEST_CASE("what a blade has parted bears a tool at rest as a body that was never whole") {
  check_bears_as_never_entire(finely_stepped(blade_scene("tensor_mass")));
}

TEST_CASE("implicit: what a blade has parted bears a tool at rest as a body that was never whole") {
  for (const auto solver : {Solver::kDirect, Solver::kQuasiNewton})
    check_bears_as_never_entire(implicit_scene(ElasticLaw::kLinear, solver));
}

TEST_CASE("hybrid: what a blade has parted bears a tool at rest as a body that was never whole") {
  Scene scene = blade_scene("hybrid");
  scene.tools[0].blade = Vec3(0, -0.008, 0);
  scene.cutting->region =
      Region{.box = Box{Vec3(-1, -0.012, -0.012), Vec3(0.002, 1, 0.012)}, .where = "test"};
  check_bears_as_never_entire(finely_stepped(std::move(scene)));
}

TEST_CASE("a blade stops at the end of what can be cut, and says so") {
  for (const char* const model : {"tensor_mass", "hybrid"}) {
    CAPTURE(model);
    Scene scene = finely_stepped(blade_scene(model));
    scene.tools[0].blade = Vec3(0, -0.008, 0);
    const auto cut_within = [&](double end) {
      scene.cutting->region =
          Region{.box = Box{Vec3(-1, -0.012, -0.012), Vec3(end, 1, 0.012)}, .where = "test"};
      auto cut = std::make_unique<Simulation>(scene, shaken_block({8, 4, 8}));
      for (int i = 0; i <= 90; ++i) slide_at(*cut, -0.022 + 0.02 * i / 60, true);  // to x = 8 mm
      return cut;
    };
    const auto inside = cut_within(0.016), beyond = cut_within(0.001);
    CHECK(inside->resection()->totals().time_at_end == 0);
    CHECK(beyond->resection()->totals().time_at_end > 0);
    const int copies = beyond->resection()->remaining().spares().first;
    for (int v = copies - static_cast<int>(beyond->resection()->totals().splits); v < copies; ++v)
      CHECK(beyond->mesh().vertices[static_cast<std::size_t>(v)].x() < 0.006);  // the end, and a cell of 5 mm
    check_bears_as_never_entire(*beyond);
  }
}

TEST_CASE("the area that a blade has parted is that of its way within the body") {
  Simulation simulation(blade_scene("tensor_mass"), shaken_block({16, 8, 16}));
  for (int i = 0; i <= 60; ++i) slide_at(simulation, -0.022 + 0.02 * i / 60, true);
  CHECK(simulation.resection()->totals().splits > 5);
  CHECK(simulation.resection()->totals().separated_area ==
        Approx(0.018 * 0.0095).epsilon(0.2));  // cells of 2.5 mm
}

TEST_CASE("a blade does the work of what it parts, against its way") {
  Scene scene = blade_scene("tensor_mass");
  Simulation simulation(scene, shaken_block({12, 6, 12}));
  const double speed = 0.02 / 60;  // m a step
  double work = 0;                 // J
  for (int i = 0; i <= 110; ++i) {
    slide_at(simulation, -0.022 + speed * i, true);
    const Vec3 on_blade = simulation.cut()->log().back().f_W - simulation.tool(0).force().force;
    CHECK(on_blade.x() <= 0);
    CHECK(std::hypot(on_blade.y(), on_blade.z()) < 1e-9);
    work -= on_blade.x() * speed;
  }
  // It owes a little at the end: what it parted last is done over the next length of an edge or so.
  const double all = scene.cutting->toughness * simulation.resection()->totals().separated_area;
  CHECK(work < all);
  CHECK(work > 0.85 * all);
  CHECK(simulation.flagged().to_text().empty());
}

TEST_CASE(
    "a blade that is let go on its way is felt until it has done the work that it owes, and no longer") {
  Scene scene = blade_scene("tensor_mass");
  Simulation simulation(scene, shaken_block({12, 6, 12}));
  const double speed = 0.02 / 60;                 // m a step
  double work = 0, before = 0, largest_drop = 0;  // J, N
  for (int i = 0; i <= 110; ++i) {
    // It cuts in every third step alone, and is let go for good in the middle of the block.
    const ToolAnswer rendered = slide_at(simulation, -0.022 + speed * i, i < 66 && i % 3 != 2);
    const double along = simulation.tool(0).force().force.x() - rendered.force.x();
    work += along * speed;
    if (i == 66) largest_drop = before - along;
    before = along;
  }
  const double all = scene.cutting->toughness * simulation.resection()->totals().separated_area;
  REQUIRE(all > 1e-4);
  CHECK(work < all);
  CHECK(work > 0.95 * all);
  CHECK(largest_drop < 0.3);
  CHECK(std::abs(before) < 0.05);  // 15 mm later
}

TEST_CASE("a blade of 5 m/s, which is through before it is felt, is flagged, and owes nothing later") {
  const auto run = [](double speed) {
    Simulation simulation(blade_scene("tensor_mass"), shaken_block({12, 6, 12}));
    double x = -0.022;
    for (; x < 0.03; x += speed * kStep) slide_at(simulation, x, true);
    ToolAnswer last;
    for (int i = 0; i < 40; ++i) last = slide_at(simulation, x, true);
    CHECK(simulation.resection()->totals().separated_area > 1e-4);  // m^2
    CHECK_FALSE(last.flagged);
    CHECK(simulation.flagged().contact == simulation.resection()->totals().outrun_steps);
    return simulation.flagged().contact;
  };
  CHECK(run(0.3) == 0);
  CHECK(run(5) > 0);
}

TEST_CASE("a blade in a step of no time feels nothing that is not finite") {
  Simulation simulation(blade_scene("tensor_mass"), shaken_block({8, 4, 8}));
  for (int i = 0; i < 30; ++i) slide_at(simulation, -0.022 + 3e-4 * i, true);
  for (int i = 0; i < 3; ++i) CHECK(slide_at(simulation, -0.022 + 3e-4 * 29, true, 0).force.allFinite());
  CHECK(slide_at(simulation, -0.022 + 3e-4 * 30, true).force.allFinite());
}

TEST_CASE("a blade is felt alike at every rate of steps") {
  const auto largest_at = [](double rate) {
    Scene scene = implicit_scene(ElasticLaw::kLinear, Solver::kDirect);
    scene.rate_hz = rate;
    Simulation simulation(scene, shaken_block({8, 4, 8}));
    double largest = 0;  // N
    for (int i = 0; i <= 2 * rate; ++i) {
      slide_at(simulation, -0.022 + 0.01 * i / rate, true, 1 / rate);
      const Vec3 on_blade = simulation.cut()->log().back().f_W - simulation.tool(0).force().force;
      largest = std::max(largest, on_blade.norm());
    }
    return largest;
  };
  const double often = largest_at(600);
  REQUIRE(often > 0.3);
  CHECK(largest_at(30) == Approx(often).epsilon(0.1));
}

TEST_CASE("of a blade that is felt nobody is told a tangent, which would be of the tissue alone") {
  Simulation simulation(implicit_scene(ElasticLaw::kLinear, Solver::kDirect), shaken_block({8, 4, 8}));
  const auto here_at = [&](int i, bool cuts) {
    ToolInput input{.buttons = static_cast<std::uint16_t>(cuts ? 1 : 0)};
    input.request.at_tool = true;
    return step(simulation, Vec3(-0.018 + 1e-3 * i, 0.0025, 0.001), input, kStep).at_tool.has_value();
  };
  for (int i = 0; i < 3; ++i) CHECK(here_at(i, false));
  int rendered = 0;
  for (int i = 3; i < 20; ++i) {
    const bool published = here_at(i, true);
    const Vec3 on_blade = simulation.cut()->log().back().f_W - simulation.tool(0).force().force;
    CHECK(published == on_blade.isZero(0));
    rendered += published ? 0 : 1;
  }
  CHECK(rendered > 10);
  here_at(20, false);
  CHECK(here_at(20, false));
}

TEST_CASE("a blade that goes anywhere, beside a hot tip, leaves a closed surface and a body that holds") {
  CHECK(flagged_by_anything(blade_scene("tensor_mass")) == 0);
}

TEST_CASE("implicit: a blade that goes anywhere, beside a hot tip, leaves a body that holds") {
  // In the last two an equilibrium that was not found once took the tool far away: 106 N on its way back, and
  // a surface that ran away. Of the last the surface is still in one step where it cannot be, which is told
  // also since pieces are loose.
  for (const auto& [solver, seed] : {std::pair(Solver::kDirect, 1U), std::pair(Solver::kQuasiNewton, 2U),
                                     std::pair(Solver::kDirect, 7U)}) {
    CAPTURE(solver, seed);
    CHECK(flagged_by_anything(implicit_scene(ElasticLaw::kCorotational, solver), seed, seed == 7 ? 1 : 0) <
          kAnything / 20);
  }
}

TEST_CASE("halves that a blade has cut apart part under traction, and one that is held by nothing falls") {
  check_halves_part(blade_scene("tensor_mass"));
  check_halves_part(implicit_scene(ElasticLaw::kCorotational, Solver::kDirect));
}

TEST_CASE("jaws hold both sides of the patch that a blade goes through, and both are judged for strain") {
  for (const Scene& scene : {blade_scene("tensor_mass"), blade_scene("hybrid"),
                             implicit_scene(ElasticLaw::kLinear, Solver::kDirect)}) {
    CAPTURE(scene.deformation.model);
    HeldWhileCut body(scene);
    const auto held = body.held();
    const double area = body.held_area();
    REQUIRE(area > 1e-4);
    const Vec3 force = body.go(-0.025, false);
    REQUIRE(force.norm() > 0.1);
    for (int i = 0; i <= 60; ++i) body.go(-0.025 + 0.05 * i / 60, true);
    Vec3 after;
    for (int i = 0; i < 60; ++i) after = body.go(0.025, false);
    const std::vector<int> copies = body.copies_of(held);
    REQUIRE(copies.size() > 2);
    CAPTURE(force.transpose(), after.transpose(), held.size(), copies.size());
    CHECK(body.held().size() == held.size() + copies.size());
    CHECK(body.held_area() == Approx(area));
    CHECK((after - force).norm() < 0.05 * force.norm());
    for (const int copy : copies) {
      CHECK(std::ranges::count(body.held(), copy) == 1);
      CHECK(body.strain_with(copy) > 2 * body.strain_with(-1));
    }
  }
}

TEST_CASE("a run that parts tissue is the same each time") {
  for (const Scene& scene :
       {blade_scene("tensor_mass"), implicit_scene(ElasticLaw::kCorotational, Solver::kQuasiNewton)}) {
    std::vector<std::uint64_t> hashes;
    for (int run = 0; run < 2; ++run) {
      Simulation simulation(scene, shaken_block({8, 4, 8}));
      for (int i = 0; i <= 60; ++i) slide_at(simulation, -0.022 + 0.02 * i / 60, true);
      hashes.push_back(simulation.state_hash());
    }
    CHECK(hashes[0] == hashes[1]);
  }
}
