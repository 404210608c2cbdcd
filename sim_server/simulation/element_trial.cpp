#include "sim_server/simulation/element_trial.h"

#include <algorithm>

#include "common/error.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/simulation/step_times.h"

namespace palpate::sim {
namespace {

constexpr int kMostNodes = 6000;  // of quadratic elements: their factor takes about a second
constexpr double kStep = 1;       // s: tissue at rest takes any

/// The same tissue at rest, of the linear law, under the first tool alone.
Scene at_rest(Scene scene) {
  const auto rests = [](const DeformationModelRow& row) {
    return row.deforms() && !row.moves && !row.needs_cutting;
  };
  scene.deformation = {};
  scene.deformation.model = std::ranges::find_if(deformation_models(), rests)->name;
  scene.material->law = ElasticLaw::kLinear;
  scene.material->relaxations.clear();
  scene.loads.clear();
  for (FixedRegion& fixed : scene.fixed) fixed.motions.clear();
  scene.tools.resize(1);
  return scene;
}

/// The force on the tool at `site`; nothing where the contact has not settled.
std::optional<Vec3> press(Simulation& simulation, const Press& site) {
  const ToolForce force = simulation.step(ToolPose(site.place), kStep);
  if (force.flagged || force.contacts == 0) return {};
  return force.force;
}

std::optional<ElementTrial> press_both(Scene scene, const TetMesh& mesh) {
  Simulation linear(scene, mesh);
  const Press site = find_press(scene, linear);
  const std::optional<Vec3> by_linear = press(linear, site);
  if (!by_linear) return {};
  const auto loads = linear.loads(0);
  const Vec3 margin = Vec3::Constant(2 * scene.tools[0].shape.radius);
  scene.tools[0].reach = Box{site.place - margin, site.place + margin};
  scene.material->element = ElementKind::kQuadratic;
  Simulation quadratic(scene, mesh);
  const std::optional<Vec3> right = press(quadratic, site);
  if (!right || right->isZero(0)) return {};
  return ElementTrial{.percent = 100 * (*by_linear - *right).norm() / right->norm(),
                      .loads = {loads.begin(), loads.end()}};
}

}  // namespace

std::optional<ElementTrial> try_elements(const Scene& scene, const TetMesh& mesh) {
  if (scene.cutting || scene.tools.front().grasps() || scene.flies()) return {};
  const MeshInfo info = describe(mesh);
  if (info.vertices + info.edges > kMostNodes) return {};
  try {
    return press_both(at_rest(scene), mesh);
  } catch (const Error&) {  // as where memory is short: then nothing is known, as without a trial
    return {};
  }
}

}  // namespace palpate::sim
