#include "sim_server/simulation/set_up_memory.h"

#include "common/error.h"
#include "sim_server/models/implicit.h"
#include "sim_server/scene_file/read_scene.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

Scene scene_with(const std::string& model, ElementKind element = ElementKind::kLinear) {
  Scene scene = test::scene_of({.element = element}, {{-1, -1, -1}, {1, 1, 1}}, 0.01);
  scene.deformation.model = model;
  return scene;
}

std::string refusal(const Scene& scene, Purpose purpose, double free) {
  // Made up: bytes are easy to add by hand.
  const MeshCounts counts{.vertices = 1000, .edges = 6000, .faces = 10000, .tetrahedra = 5000};
  try {
    require_memory_for(scene, purpose, counts, free);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a scene beyond the machine is refused with the estimate, before anything is built") {
  // Elements: 1000 24 + 5000 (16 + 8 + 96); matrix: 112 (1000 + 6000) + 20 1000; lists: 5000 54:
  // 0.624 + 0.804 + 0.27 MB.
  const Scene still = scene_with("quasi_static");
  CHECK(refusal(still, Purpose::kServe, 1.699e6).empty());
  CHECK(refusal(still, Purpose::kServe, 1.697e6) ==
        "test: the stiffness of 5000 tetrahedra would take 1.7 MB, and 1.7 MB are free; take a coarser mesh");
  // 1000 (48 + 4) + 6000 (72 + 4) + 5000 48: 0.748 MB
  CHECK(refusal(scene_with("tensor_mass"), Purpose::kServe, 0.749e6).empty());
  CHECK_FALSE(refusal(scene_with("tensor_mass"), Purpose::kServe, 0.747e6).empty());
  CHECK(refusal(scene_with("implicit"), Purpose::kServe, 1.699e6).empty());
  CHECK_FALSE(refusal(scene_with("implicit"), Purpose::kServe, 1.697e6).empty());
  Scene background = scene_with("implicit");  // the matrix twice: 0.804 MB more
  background.deformation.of<ImplicitSettings>().solver = DynamicsSettings::Solver::kQuasiNewton;
  CHECK(refusal(background, Purpose::kServe, 2.503e6).empty());
  CHECK_FALSE(refusal(background, Purpose::kServe, 2.501e6).empty());
  // Supports that move: tensor_mass makes a body as quasi_static does, implicit
  // finds its shape with two more matrices: 1.698 + 2 0.804 MB.
  Scene tensors = scene_with("tensor_mass"), implicit = scene_with("implicit");
  tensors.fixed[0].motions = implicit.fixed[0].motions = {{Vec3::UnitX(), 0.01, 4}};
  CHECK(refusal(tensors, Purpose::kServe, (0.748 + 1.699) * 1e6).empty());
  CHECK_FALSE(refusal(tensors, Purpose::kServe, (0.748 + 1.697) * 1e6).empty());
  CHECK(refusal(implicit, Purpose::kServe, 3.307e6).empty());
  CHECK_FALSE(refusal(implicit, Purpose::kServe, 3.305e6).empty());
  Scene weighed = scene_with("implicit");
  weighed.loads.push_back({.kind = Load::Kind::kGravity, .vector = {0, -9.81, 0}});
  CHECK_FALSE(refusal(weighed, Purpose::kServe, 3.305e6).empty());
  // Vectors of modes: 3 1000 8 (3 40 + 20) bytes, 3.36 MB.
  CHECK(refusal(scene_with("reduced"), Purpose::kServe, (1.699 + 3.36) * 1e6).empty());
  CHECK_FALSE(refusal(scene_with("reduced"), Purpose::kServe, (1.697 + 3.36) * 1e6).empty());
  CHECK(refusal(still, Purpose::kSolve, 2.503e6).empty());  // the matrix twice
  CHECK_FALSE(refusal(still, Purpose::kSolve, 2.501e6).empty());
  CHECK(refusal(scene_with("implicit", ElementKind::kQuadratic), Purpose::kServe, 1e6)
            .find("another `element`") != std::string::npos);
  CHECK(refusal(scene_with("rigid"), Purpose::kServe, 0).empty());
}
