#include "sim_server/models/deformation_models.h"
#include "sim_server/models/reduced.h"
#include "sim_server/models/rigid.h"
#include "sim_server/models/spring.h"
#include "sim_server/scene/inclusions.h"
#include "sim_server/scene/scene_print.h"
#include "sim_server/tissue/rayleigh_damping.h"
#include "tests/support/catch.h"
#include "tests/support/soft_block.h"

using namespace palpate;
using namespace palpate::sim;

TEST_CASE("scene print: what forces follow from changes its own part, numerics and texts none") {
  const Scene scene = test::little_block_scene();
  const TetMesh mesh = test::little_block({2, 1, 2});
  const auto print_with = [](const Scene& one, const TetMesh& on) {
    return print_of(one, on, model_of(one.deformation).body_to_text(one.deformation));
  };
  const protocol::ScenePrint print = print_with(scene, mesh);
  const auto differing = [&](const auto& change) {
    Scene other = scene;
    TetMesh other_mesh = mesh;
    change(other, other_mesh);
    return protocol::differences(print, print_with(other, other_mesh));
  };
  CHECK(differing([](Scene&, TetMesh& m) { m.vertices[3].x() += 1e-9; }) == "mesh");
  CHECK(differing([](Scene&, TetMesh& m) { m.tetrahedra.pop_back(); }) == "mesh");
  CHECK(differing([](Scene& s, TetMesh&) { s.material->young_modulus *= 1.01; }) == "material");
  CHECK(differing([](Scene& s, TetMesh&) { s.material->poisson_ratio = 0.41; }) == "material");
  CHECK(differing([](Scene& s, TetMesh&) { s.material->element = ElementKind::kQuadratic; }) == "material");
  CHECK(differing([](Scene& s, TetMesh&) { s.material->relaxations = {{0.5, 1}}; }) == "material");
  CHECK(differing([](Scene& s, TetMesh& m) {
          s.inclusions.push_back({{.ball = Ball{Vec3::Zero(), 1}}, 1e3});
          put_inclusions(s, m);
        }) == "material");
  CHECK(differing([](Scene& s, TetMesh&) { s.cutting = Cutting{}; }) == "material");
  CHECK(differing([](Scene& s, TetMesh&) { s.fixed[0].box->max.y() += 1e-6; }) == "supports or loads");
  CHECK(differing([](Scene& s, TetMesh&) {
          s.fixed[0].motions.push_back({.direction = Vec3::UnitX(), .amplitude = 0.01, .period = 4});
        }) == "supports or loads");
  CHECK(differing([](Scene& s, TetMesh&) {
          s.loads = {{.kind = Load::Kind::kGravity, .vector = Vec3(0, -9.81, 0)}};
        }) == "supports or loads");
  CHECK(differing([](Scene& s, TetMesh&) { s.tools[0].shape.radius = 0.004; }) == "tools or model");
  CHECK(differing([](Scene& s, TetMesh&) { s.tools[0].shape.friction = 0.3; }) == "tools or model");
  CHECK(differing([](Scene& s, TetMesh&) { s.tools.push_back(s.tools[0]); }) == "tools or model");
  CHECK(differing([](Scene& s, TetMesh&) { s.deformation.model = "implicit"; }) == "tools or model");
  CHECK(differing([](Scene& s, TetMesh&) {
          s.tools[0].reach = Box{Vec3::Zero(), Vec3::Ones()};
        }) == "tools or model");
  CHECK(differing([](Scene& s, TetMesh&) {
          s.tools[0].reach = Cone{Vec3::Zero(), Vec3::UnitX(), 0.5, 0.2};
        }) == "tools or model");
  CHECK(differing([](Scene& s, TetMesh&) { s.tools[0].grasp_place = Vec3::Zero(); }) == "tools or model");
  CHECK(differing([](Scene& s, TetMesh&) { s.tools[0].grasp_buttons = 1; }) == "tools or model");
  CHECK(differing([](Scene& s, TetMesh&) { s.tools[0].cut_buttons = 2; }) == "tools or model");
  CHECK(differing([](Scene& s, TetMesh&) {
          s.rate_hz = 2000;
          s.title = "another";
          s.source = "other.toml";
          s.tools[0].reach_where = "other.toml:3";
        }).empty());
}

TEST_CASE(
    "scene print: what the settings of a model say of the body changes it, how exactly it is solved not") {
  const TetMesh mesh = test::little_block({2, 1, 2});
  const auto print_with = [&](const char* model, const auto& settings) {
    Scene scene = test::little_block_scene();
    scene.deformation.model = model;
    scene.deformation.of<std::decay_t<decltype(settings)>>() = settings;
    return print_of(scene, mesh, model_of(scene.deformation).body_to_text(scene.deformation));
  };
  CHECK_FALSE(print_with("rigid", RigidSettings{800}) == print_with("rigid", RigidSettings{801}));
  CHECK_FALSE(print_with("spring", SpringSettings{.hardening_length = 0.1}) ==
              print_with("spring", SpringSettings{.hardening_length = 0.2}));
  CHECK_FALSE(print_with("tensor_mass", RayleighDamping{.mass = 10}) ==
              print_with("tensor_mass", RayleighDamping{.mass = 100}));
  CHECK(print_with("reduced", ReducedSettings{.modes = 20}) ==
        print_with("reduced", ReducedSettings{.modes = 40}));
}
