// What clients are told of a tissue that swings: its slow modes, where they stand, and the rest.
#include "sim_server/client_model/slow_modes.h"

#include <numeric>

#include "sim_server/client_model/published_motion.h"
#include "sim_server/models/implicit.h"
#include "sim_server/models/reduced.h"
#include "sim_server/serving/surface_pager.h"
#include "sim_server/simulation/simulation.h"
#include "tests/support/catch.h"
#include "tests/support/served_block.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr double kStep = 0.01;  // s

/// Soft, so that its modes are slow.
Scene soft_block(std::string_view model) {
  Scene scene = block_scene();
  scene.material->young_modulus = 2e3;
  scene.material->density = 1000;
  scene.rate_hz = 1 / kStep;
  scene.deformation.model = model;
  scene.deformation.of<ReducedSettings>().modes = 20;
  scene.deformation.of<ClientModes>().modes = 20;
  return scene;
}

constexpr std::array<int, 4> kSome{3, 17, 40, 60};  // surface vertices, on the top and the sides

Eigen::MatrixXd of_patch(const auto& fill) {
  ContactPatch patch;
  patch.reserve(kSome.size(), 0);
  patch.free.resize(kSome.size());
  fill(patch);
  return patch.compliance.topLeftCorner(3 * kSome.size(), 3 * kSome.size());
}

}  // namespace

TEST_CASE("slow modes: with what they give way to at rest, the rest is the static compliance") {
  const Simulation at_rest(soft_block("quasi_static"), block_mesh());
  const Eigen::MatrixXd right =
      of_patch([&](ContactPatch& patch) { at_rest.model().compliance(kSome, patch); });
  for (const std::string_view model : {"tensor_mass", "reduced", "implicit"}) {
    CAPTURE(model);
    const Simulation swings(soft_block(model), block_mesh());
    const PublishedModes* const modes = swings.published_modes();
    REQUIRE(modes != nullptr);
    REQUIRE(modes->published == 20);
    Eigen::MatrixXd sum =
        of_patch([&](ContactPatch& patch) { swings.traits().client->residual_compliance(kSome, patch); });
    CHECK((sum - right).norm() > 0.05 * right.norm());  // the modes matter
    for (Eigen::Index k = 0; k < modes->published; ++k) {
      Eigen::VectorXd shape(3 * kSome.size());
      for (std::size_t i = 0; i < kSome.size(); ++i)
        shape.segment<3>(3 * static_cast<Eigen::Index>(i)) = modes->shapes.col(k).segment<3>(3 * kSome[i]);
      sum += shape * shape.transpose() / (modes->frequencies[k] * modes->frequencies[k]);
    }
    CHECK((sum - right).norm() < 1e-6 * right.norm());
  }
}

TEST_CASE("slow modes: where they stand is where the surface has swung to, under a load and after it") {
  for (const std::string_view model : {"tensor_mass", "reduced", "implicit"}) {
    CAPTURE(model);
    Scene scene = soft_block(model);
    scene.deformation.of<RayleighDamping>().stiffness = 3e-3;  // what is quick is soon gone
    Simulation swings(scene, block_mesh());
    const PublishedModes& modes = *swings.published_modes();
    std::vector<ToolInput> input(1);
    const Vec3 pressed(0.001, 0.002, 0.0005);
    double worst = 0, largest = 0;
    for (int step = 0; step < 60; ++step) {
      input[0] = {.request = {.at_tool = true, .surface_shift = true}};
      input[0].pose =
          step < 20 ? Vec3(pressed + Vec3(0, std::max(0.0, 0.005 - 0.0005 * step), 0)) : Vec3(0, 0.012, 0);
      const ToolAnswer answer = swings.step(input, kStep).front();
      CAPTURE(step, answer.flagged);
      REQUIRE(answer.modes != nullptr);
      CHECK(answer.surface_shift_W->isZero(0));  // its supports rest
      if (step < 25) continue;
      // Free of the tool for some steps: what is left is slow.
      for (const int v : kSome) {
        Vec3 published = Vec3::Zero();
        for (Eigen::Index k = 0; k < modes.published; ++k)
          published += answer.modes->q[k] * modes.shapes.col(k).segment<3>(3 * v);
        const Vec3 moved =
            swings.positions()[static_cast<std::size_t>(v)] - swings.rest()[static_cast<std::size_t>(v)];
        worst = std::max(worst, (published - moved).norm());
        largest = std::max(largest, moved.norm());
      }
    }
    CAPTURE(worst, largest);
    CHECK(largest > 5e-6);
    CHECK(worst < 0.1 * largest);
  }
}

TEST_CASE(
    "slow modes: of a tissue that relaxes, where the modes stand and the compliance of the rest under what "
    "is not forgotten are where the surface is, while it creeps and when it is left") {
  for (const bool held : {true, false}) {
    Scene scene = soft_block("implicit");
    scene.deformation.of<RayleighDamping>().stiffness = 3e-3;
    scene.material->relaxations = {{0.4, 0.1}, {0.2, 0.7}};
    Simulation swings(scene, block_mesh());
    const PublishedModes& modes = *swings.published_modes();
    REQUIRE(modes.relaxations.size() == 2);
    std::vector<ToolInput> input(1);
    const auto step = [&](const Vec3& p) {
      input[0] = {.pose = p, .request = {.at_tool = true, .surface_shift = true}};
      return swings.step(input, kStep).front();
    };
    ToolAnswer answer;
    for (int i = 0; i < 60; ++i) answer = step({0.001, 0.002, 0.0005});
    if (!held) {
      for (int i = 0; i < 25; ++i) answer = step({0, 0.02, 0});
    }
    REQUIRE(answer.modes != nullptr);
    REQUIRE((answer.force.norm() > 0) == held);
    std::vector<int> all(swings.rest().size());
    std::iota(all.begin(), all.end(), 0);
    ContactPatch patch;
    patch.reserve(static_cast<int>(all.size()), 0);
    patch.free.resize(all.size());
    swings.traits().client->residual_compliance(all, patch);
    const auto size = static_cast<Eigen::Index>(3 * all.size());
    Eigen::VectorXd phi = Eigen::VectorXd::Zero(size);
    for (const VertexLoad& load : swings.loads(0)) phi.segment<3>(3 * load.vertex) += load.force;
    for (std::size_t v = 0; v < all.size(); ++v)
      phi.segment<3>(static_cast<Eigen::Index>(3 * v)) +=
          0.4 * answer.modes->psi[2 * v] + 0.2 * answer.modes->psi[2 * v + 1];
    const Eigen::VectorXd published = patch.compliance.topLeftCorner(size, size) * phi +
                                      modes.shapes.leftCols(modes.published) * answer.modes->q;
    double worst = 0, largest = 0;
    for (std::size_t v = 0; v < all.size(); ++v) {
      const Vec3 moved = swings.positions()[v] - swings.rest()[v];
      worst = std::max(worst, (moved - published.segment<3>(static_cast<Eigen::Index>(3 * v))).norm());
      largest = std::max(largest, moved.norm());
    }
    CAPTURE(held, worst, largest);
    CHECK(worst < 0.02 * largest);
    CHECK(largest > 1e-5);
    // And z is what a mode must be held back by, so that it stands where it stands: w^2 (q - sum g z) = s f.
    if (!held) continue;
    double off = 0, force = 0;
    for (Eigen::Index k = 0; k < 5; ++k) {
      double pushed = 0;
      for (const VertexLoad& load : swings.loads(0))
        pushed += modes.shapes.col(k).segment<3>(3 * load.vertex).dot(load.force);
      const double w2 = modes.frequencies[k] * modes.frequencies[k], q = answer.modes->q[k];
      off += std::abs(w2 * (q - 0.4 * answer.modes->z(k, 0) - 0.2 * answer.modes->z(k, 1)) - pushed);
      force += std::abs(pushed);
    }
    CHECK(off < 0.03 * force);
  }
}

TEST_CASE(
    "slow modes: what another tool does to them and to all the rest is told, of each tool that of the "
    "other") {
  for (const std::string_view model : {"tensor_mass", "reduced", "implicit"}) {
    CAPTURE(model);
    Scene scene = soft_block(model);
    scene.deformation.of<RayleighDamping>() = {.mass = 20, .stiffness = 3e-3};  // at rest soon
    scene.tools.push_back(scene.tools.front());
    Simulation swings(scene, block_mesh());
    const PublishedModes& modes = *swings.published_modes();
    std::vector<ToolInput> inputs(2);
    inputs[0] = {.pose = Vec3(0.004, 0.003, 0.001), .request = {.at_tool = true, .surface_shift = true}};
    inputs[1] = {.pose = Vec3(-0.008, 0.0025, -0.008), .request = {.at_tool = true, .surface_shift = true}};
    std::span<const ToolAnswer> answers;
    for (int i = 0; i < 300; ++i) answers = swings.step(inputs, kStep);
    for (std::size_t tool = 0; tool < 2; ++tool) {
      const ToolAnswer& answer = answers[tool];
      CAPTURE(tool);
      REQUIRE(answer.modal_loads != nullptr);
      REQUIRE(answer.force.norm() > 0.01);
      // At rest, w^2 q is how hard both tools together drive a mode.
      Eigen::VectorXd driven = *answer.modal_loads;
      for (const VertexLoad& load : swings.loads(tool))
        driven +=
            modes.shapes.middleRows<3>(3 * load.vertex).leftCols(modes.published).transpose() * load.force;
      const Eigen::VectorXd w2 = modes.frequencies.head(modes.published).array().square();
      const Eigen::VectorXd pulled = w2.cwiseProduct(answer.modes->q);
      CHECK((pulled - driven).norm() < 1e-3 * driven.norm());
      CHECK(answer.modal_loads->norm() > 0.1 * driven.norm());
      // And the surface is where these modes, this tool and the shift by the other one put it.
      const auto place = std::ranges::min_element(swings.rest(), {}, [&](const Vec3& rest) {
        return (rest + *answer.surface_shift_W - inputs[tool].pose->p_W).norm();
      });
      const auto vertex = static_cast<int>(place - swings.rest().begin());
      const auto row = 3 * static_cast<Eigen::Index>(vertex);
      Vec3 published = *answer.surface_shift_W +
                       modes.shapes.middleRows<3>(row).leftCols(modes.published) * answer.modes->q;
      ContactPatch patch;
      patch.reserve(2, 0);
      patch.free.resize(2);
      for (const VertexLoad& load : swings.loads(tool)) {
        swings.traits().client->residual_compliance(std::array{vertex, load.vertex}, patch);
        published += patch.compliance.block<3, 3>(0, 3) * load.force;
      }
      const Vec3 moved = swings.positions()[static_cast<std::size_t>(vertex)] - *place;
      CHECK((published - moved).norm() < 1e-3 * moved.norm());
      CHECK(answer.surface_shift_W->norm() > 0.01 * moved.norm());
    }
  }
}

TEST_CASE("slow modes: on supports that move they stand where the tool has moved the surface beyond these") {
  Scene resting = soft_block("implicit"), moving = resting;
  for (Scene* const scene : {&resting, &moving})
    scene->deformation.of<ImplicitSettings>().second_order = true;
  moving.fixed[0].motions = {{.direction = Vec3(0.6, 0.8, 0), .amplitude = 0.003, .period = 0.8}};
  Simulation still(resting, block_mesh()), moves(moving, block_mesh());
  REQUIRE(moves.published_modes() != nullptr);
  std::vector<ToolInput> input(1);
  const auto step = [&](Simulation& simulation, const Vec3& p) -> ToolAnswer {
    input[0] = {.pose = p, .request = {.at_tool = true, .surface_shift = true}};
    return simulation.step(input, kStep).front();
  };
  double worst = 0, largest = 0;
  Vec3 shift = Vec3::Zero();
  for (int i = 1; i <= 150; ++i) {
    const Vec3 p(0.001, 0.003 + 0.001 * std::cos(0.1 * i), 0.0005);
    const ToolAnswer a = step(still, p);
    const ModalMotion right = *a.modes;
    const ToolAnswer b = step(moves, p + shift);  // the tool goes along, a step late
    shift = *b.surface_shift_W + kStep * b.surface_v_W;
    REQUIRE(b.modes != nullptr);
    if (i < 30) continue;
    largest = std::max(largest, right.q.norm());
    worst = std::max(worst, (b.modes->q - right.q).norm());
  }
  CAPTURE(worst, largest);
  CHECK(worst < 0.05 * largest);
}

TEST_CASE("slow modes: their pages are numbered behind the tiles, and hold shapes and spectrum") {
  const Simulation swings(soft_block("reduced"), block_mesh());
  const PublishedModes& modes = *swings.published_modes();
  SurfacePager pager(swings, 0);
  const protocol::SurfacePages pages = pager.pages();
  CHECK(pages.modes == 20);
  CHECK(pages.groups() == 2);
  protocol::SurfacePage page;
  REQUIRE(pager.page(pages.spectrum(), page));
  CHECK(page.values[3 * 7] == static_cast<float>(modes.frequencies[7]));
  CHECK(page.values[3 * 7 + 1] == static_cast<float>(modes.damping[7]));
  REQUIRE(pager.page(pages.shapes(pages.clusters() - 1, 1), page));
  CHECK_FALSE(pager.page(pages.count(), page));
  // The first vertex of the second cluster, in mode 16: by where that vertex is.
  protocol::SurfacePage places;
  REQUIRE(pager.page(0, places));
  const Vec3 p(static_cast<double>(places.values[15]), static_cast<double>(places.values[16]),
               static_cast<double>(places.values[17]));
  std::size_t vertex = 0;
  for (std::size_t v = 0; v < swings.rest().size(); ++v)
    if ((swings.rest()[v] - p).norm() < (swings.rest()[vertex] - p).norm()) vertex = v;
  REQUIRE(pager.page(pages.shapes(1, 1), page));
  for (int axis = 0; axis < 3; ++axis)
    CHECK(page.values[static_cast<std::size_t>(axis * 15 + 1)] ==
          static_cast<float>(modes.shapes(3 * static_cast<Eigen::Index>(vertex) + axis, 16)));
}

TEST_CASE(
    "slow modes: none are told where tissue rests, where it relaxes under several tools or in more ways than "
    "clients step, or where the scene says 0") {
  CHECK(Simulation(soft_block("quasi_static"), block_mesh()).published_modes() == nullptr);
  Scene relaxes = soft_block("implicit");
  relaxes.material->relaxations.assign(kMostRelaxations, {0.1, 0.02});
  CHECK(Simulation(relaxes, block_mesh()).published_modes() != nullptr);
  relaxes.material->relaxations.push_back({0.1, 0.3});
  CHECK(Simulation(relaxes, block_mesh()).published_modes() == nullptr);
  Scene none = soft_block("tensor_mass");
  none.deformation.of<ClientModes>().modes = 0;
  CHECK(Simulation(none, block_mesh()).published_modes() == nullptr);
  relaxes.material->relaxations.assign(1, {0.1, 0.3});
  relaxes.tools.push_back(relaxes.tools.front());
  CHECK(Simulation(relaxes, block_mesh()).published_modes() == nullptr);
}

TEST_CASE(
    "slow modes: of a stiff body all are too quick to be told, and its pages are those of its compliance") {
  Scene stiff = soft_block("reduced");
  stiff.material->young_modulus = 50e6;
  const Simulation simulation(stiff, block_mesh());
  CHECK(simulation.published_modes() == nullptr);
  CHECK(SurfacePager(simulation, 0).pages().modes == 0);
}
