#include "sim_server/study/study_plan.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/core.h>

#include "common/error.h"
#include "sim_server/mesh/gmsh_io.h"
#include "sim_server/mesh/refinement.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/models/implicit.h"
#include "sim_server/scene/inclusions.h"
#include "sim_server/scene_file/read_parts.h"

namespace palpate::sim {
namespace {

constexpr double kMostTetrahedra = 22e3;  // of a timed mesh
// Of references: nodes, of those in motion (one factor serves the linear law) and at rest.
constexpr double kMostNodes = 14.5e3, kMostNodesLinear = 26e3, kMostNodesQuick = 4e3, kMostNodesAtRest = 36e3,
                 kMostNodesAtRestQuick = 25e3;
// Of references: the shortest edge under the tool, of its radius (with friction each touching node costs far
// more); how much shorter each try is; and how fast edges grow away from there.
constexpr double kShortEdge = 0.2, kShortEdgeRubbed = 0.6, kShorter = 0.7, kGrowth = 0.7;
constexpr int kReferenceSteps = 4;                      // to one of the scene
constexpr double kUsualRate = 30;                       // Hz, where the scene names none
constexpr std::array kSteps{0.25, 0.5, 1.0, 2.0, 4.0};  // of the scene's, s
constexpr std::array kStepsOfElements{0.5, 2.0};  // of the scene's: where a better element comes too late
constexpr std::array kTolerances{1e-1, 1e-2, 1e-3, 1e-5, 1e-8};  // key `tolerance`
constexpr std::array kElements{ElementKind::kLinear, ElementKind::kNodalPressure, ElementKind::kQuadratic};

bool takes(const DeformationModelRow& row, ElementKind element) {
  return element == ElementKind::kLinear || row.materials >= Materials::kLinear;
}

/// The scene as `model` can do it: by the linear law where it knows no other.
Scene with_model(Scene scene, const DeformationModelRow& row) {
  scene.deformation.model = row.name;
  if (row.materials == Materials::kAny) return scene;
  scene.material->law = ElasticLaw::kLinear;
  scene.material->relaxations.clear();
  scene.loads.clear();
  if (!takes(row, scene.material->element)) scene.material->element = ElementKind::kLinear;
  if (row.materials < Materials::kLinear) scene.material->fibres.reset();
  return scene;
}

std::string fixed_tag(std::size_t region) {
  return fmt::format("fixed region {}", region + 1);
}

double quadratic_nodes(TetMesh mesh) {
  add_mid_edges(mesh);
  return static_cast<double>(mesh.vertices.size());
}

class Planner {
 public:
  Planner(const Scene& scene, const StudyOptions& options) : base_(scene), options_(options) {
    if (base_.rate_hz <= 0) base_.rate_hz = kUsualRate;
    mesh_ = read_mesh_of(base_);
    for (std::size_t k = 0; k < base_.fixed.size(); ++k) {
      vertices_in(base_.fixed[k], mesh_);  // there are some
    }
  }

  StudyPlan plan() {
    StudyPlan plan;
    cases_ = &plan.cases;
    add("scene", base_, 0);
    for (const DeformationModelRow& row : deformation_models()) {
      if (row.deforms() && (base_.cutting || !row.needs_cutting)) add("model", with_model(base_, row), 0);
    }
    for (const ElementKind element : kElements) {
      if (element == ElementKind::kNodalPressure && !base_.inclusions.empty()) continue;  // of one stiffness
      Scene other = base_;
      if (!takes(model_of(base_.deformation), element)) other = with_model(base_, of_any_material());
      other.material->element = element;
      add("element", other, 0);
      for (const double step : kStepsOfElements) {
        Scene slower = other;
        slower.rate_hz /= step;
        if (!options_.quick) add("step", slower, 0);
      }
    }
    add_meshes();
    if (model_of(base_.deformation).takes<ImplicitSettings>()) add_tolerances();
    add_references(plan);
    return plan;
  }

 private:
  /// The model that any scene can be held against.
  static const DeformationModelRow& of_any_material() {
    const auto rows = deformation_models();
    return *std::ranges::find(rows, Materials::kAny, &DeformationModelRow::materials);
  }

  void add(const std::string& axis, const Scene& scene, double refinements) {
    StudyCase one{axis, scene, refinements};
    const std::string name = one.name();
    const auto same = [&](const StudyCase& other) { return other.name() == name; };
    if (std::none_of(cases_->begin(), cases_->end(), same)) cases_->push_back(std::move(one));
  }

  /// Meshes, each with all steps in time: a finer mesh may pay, or come too late.
  void add_meshes() {
    std::vector<std::pair<Scene, double>> meshes{{base_, 0}};
    for (const auto& file : options_.meshes) {
      Scene other = base_;
      for (const auto& [before, refinements] : meshes) {
        if (before.mesh_file.stem() == file.stem())
          fail("--mesh {}: has the name of {}, and cases are known by it; rename one", file.string(),
               before.mesh_file.string());
      }
      other.mesh_file = file;
      const TetMesh mesh = read_mesh_of(other);
      for (const FixedRegion& region : base_.fixed) vertices_in(region, mesh);  // there are some
      meshes.emplace_back(other, 0);
    }
    const auto cells = static_cast<double>(mesh_.tetrahedra.size());
    for (double r = 0.5; cells * std::pow(8, r) <= kMostTetrahedra && !options_.quick; r += 0.5)
      meshes.emplace_back(base_, r);
    for (const auto& [scene, refinements] : meshes) {
      add("mesh", scene, refinements);
      for (const double step : kSteps) {
        if (options_.quick && (step < 0.5 || step > 2)) continue;
        Scene other = scene;
        other.rate_hz /= step;
        add("step", other, refinements);
      }
    }
  }

  void add_tolerances() {
    for (const double tolerance : kTolerances) {
      Scene other = base_;
      auto& steps = other.deformation.of<ImplicitSettings>();
      steps.tolerance = tolerance;
      steps.max_newton = 100;
      add("tolerance", other, 0);
    }
  }

  /// A scene at rest is held against statics, one in motion against motion.
  void add_references(StudyPlan& plan) const {
    const bool quick = options_.quick, rests = !model_of(base_.deformation).moves;
    Scene exact = rests ? base_ : with_model(base_, of_any_material());
    exact.deformation.of<ImplicitSettings>() = {.second_order = true, .max_newton = 60, .tolerance = 1e-7};
    exact.rate_hz *= kReferenceSteps;
    exact.material->element = ElementKind::kQuadratic;
    plan.reference = {"reference", exact, 0};
    plan.most_nodes = quick                                        ? kMostNodesQuick
                      : exact.material->law == ElasticLaw::kLinear ? kMostNodesLinear
                                                                   : kMostNodes;
    if (rests) plan.most_nodes = quick ? kMostNodesAtRestQuick : kMostNodesAtRest;
    plan.check = plan.reference;
    plan.check.axis = "check";
    plan.check.scene.rate_hz /= 2;
  }

  Scene base_;
  const StudyOptions& options_;
  TetMesh mesh_;
  std::vector<StudyCase>* cases_ = nullptr;
};

}  // namespace

std::string StudyCase::name() const {
  const DeformationSettings& by = scene.deformation;
  std::string name =
      fmt::format("{}-{}-{}-{}-r{:g}", by.model, name_of(scene.material->law),
                  name_of(scene.material->element), scene.mesh_file.stem().string(), refinements);
  if (edge > 0) name += fmt::format("-{:.3g}mm", 1e3 * edge);
  name += fmt::format("-{:.4g}ms", 1e3 / scene.rate_hz);
  if (model_of(by).takes<ImplicitSettings>()) {
    const auto& steps = by.of<ImplicitSettings>();
    name += fmt::format("-{:g}-{}{}", steps.tolerance, steps.max_newton, steps.second_order ? "-bdf2" : "");
  }
  return name;
}

void refine_references(StudyPlan& plan, const Box& near) {
  StudyCase& reference = plan.reference;
  reference.near = plan.check.near = near;
  const TetMesh coarsest = mesh_of(reference);
  const Tool& tool = reference.scene.tools.front().shape;
  const double shortest = (tool.friction > 0 ? kShortEdgeRubbed : kShortEdge) * tool.radius;
  for (double edge = describe(coarsest).median_edge; edge >= shortest; edge *= kShorter) {
    StudyCase finer = reference;
    finer.edge = edge;
    if (quadratic_nodes(mesh_of(finer)) > plan.most_nodes) break;
    reference = finer;
  }
  plan.check.edge = 2 * reference.edge;
  if (reference.edge > 0) return;
  const ElementKind own = plan.cases.front().scene.material->element;
  plan.check.scene.material->element = own == ElementKind::kQuadratic ? ElementKind::kLinear : own;
  std::erase_if(plan.cases, [](const StudyCase& one) {  // what is as fine says nothing; the scene stays
    return one.axis != "scene" && one.scene.material->element == ElementKind::kQuadratic;
  });
}

TetMesh mesh_of(const StudyCase& one) {
  TetMesh mesh = read_mesh_of(one.scene);
  for (std::size_t k = 0; k < one.scene.fixed.size(); ++k)
    mesh.surface_tags[fixed_tag(k)] = vertices_in(one.scene.fixed[k], mesh);
  put_inclusions(one.scene, mesh);  // of all refinements those of the mesh
  for (double remaining = one.refinements; remaining > 0; --remaining)
    mesh = remaining < 1 ? halved(mesh) : refined(mesh);
  if (one.edge == 0) return mesh;
  const Eigen::AlignedBox3d near(one.near.min, one.near.max);
  return graded(mesh, [&](const Vec3& x) { return one.edge + kGrowth * near.exteriorDistance(x); });
}

Simulation simulation_of(const StudyCase& one, const Progress& progress) {
  Scene scene = one.scene;
  for (std::size_t k = 0; k < scene.fixed.size(); ++k) {
    scene.fixed[k].box.reset();
    scene.fixed[k].ball.reset();
    scene.fixed[k].surface_tag = fixed_tag(k);
  }
  return Simulation(scene, mesh_of(one), progress);
}

StudyPlan plan_study(const Scene& scene, const StudyOptions& options) {
  if (!scene.material || !model_of(scene.deformation).deforms())
    fail("{}: model \"{}\" has no tissue to study; take {}", scene.deformation.where, scene.deformation.model,
         models_that([](const DeformationModelRow& m) { return m.deforms(); }));
  if (scene.flies())
    fail("{}: nothing holds the body, so that errors would grow as it flies; add a [[fixed]]", scene.source);
  return Planner(scene, options).plan();
}

}  // namespace palpate::sim
