#pragma once
/// Every deformation model with every law and solver it takes, and what is not asked of some of them.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "sim_server/deformation/deformation_models.h"
#include "sim_server/mesh/shapes.h"
#include "tests/support/scenes.h"

namespace palpate::test {

/// What physics, or its method, does not let a model do.
struct Exemption {
  std::string_view model, from, reason;
};
inline constexpr std::array kExemptions{
    Exemption{"rigid", "static limit", "it does not deform"},
    Exemption{"spring", "static limit", "the organ moves as one piece, not as its [material] says"},
    Exemption{"spring", "elastic energy", "what it stores is in the spring, not in the [material]"},
    Exemption{"spring", "turning", "the axes of `spring_stiffness` are the world's"},
    Exemption{"implicit", "no allocation", "it factors matrices as it goes"},
    Exemption{"implicit", "slope in motion",
              "but for a linear law its factor is of where the body was before"},
};
inline bool exempt(std::string_view model, std::string_view from) {
  return std::any_of(kExemptions.begin(), kExemptions.end(),
                     [&](const Exemption& e) { return e.model == model && e.from == from; });
}

/// A row of the registry, with a law and a solver that it takes.
struct ModelCase {
  using Solver = sim::DynamicsSettings::Solver;
  const sim::DeformationModelRow& row;
  sim::ElasticLaw law = sim::ElasticLaw::kLinear;
  Solver solver = Solver::kDirect;

  std::string name() const {
    constexpr std::array kLaws{"linear", "corotational", "stvk", "neo_hookean"};
    constexpr std::array kSolvers{"", ", conjugate gradients", ", quasi-Newton"};
    return std::string(row.name) + ", " + kLaws[static_cast<std::size_t>(law)] +
           kSolvers[static_cast<std::size_t>(solver)];
  }
  bool linear() const { return law == sim::ElasticLaw::kLinear; }
  /// How long (steps) loads are to be held until compliance is of here and now.
  int held_until_fresh() const { return linear() || !exempt(row.name, "slope in motion") ? 0 : 60; }
  /// Writes the choice into a scene, and has iterations go on until rounding ends them.
  void choose(sim::Scene& scene) const {
    scene.deformation.model = row.name;
    scene.material->law = law;
    scene.deformation.solver = solver;
    scene.deformation.refresh_steps = 2;
    scene.deformation.modes = 8;
    scene.deformation.tolerance = 1e-11;
    scene.deformation.max_newton = 60;
  }
};

inline std::vector<ModelCase> model_cases() {
  using sim::ElasticLaw;
  using Solver = ModelCase::Solver;
  std::vector<ModelCase> cases;
  for (const sim::DeformationModelRow& row : sim::deformation_models()) {
    cases.push_back({row});
    if (!row.any_material) continue;
    for (const ElasticLaw law :
         {ElasticLaw::kCorotational, ElasticLaw::kStVenantKirchhoff, ElasticLaw::kNeoHookean})
      cases.push_back({row, law});
    cases.push_back({row, ElasticLaw::kCorotational, Solver::kConjugateGradients});
    cases.push_back({row, ElasticLaw::kCorotational, Solver::kQuasiNewton});
  }
  return cases;
}

/// A small block held at its bottom, z = 0, with one model on it. All of its surface is in reach.
struct ModelBench {
  struct Setting {
    Eigen::Isometry3d place = Eigen::Isometry3d::Identity();  ///< where the whole scene is
    bool thin = false;                                        ///< no vertex inside
    double rate_hz = 1000, rayleigh_mass = 10, rayleigh_stiffness = 1e-4;
  };
  sim::TetMesh mesh;
  sim::Surface surface;
  sim::Scene scene = scene_of({8e3, 0.4, 1000}, {Vec3(-1, -1, -1), Vec3(1, 1, 0)}, 0.005);
  std::vector<int> fixed, reachable;
  std::unique_ptr<sim::DeformationModel> model;

  explicit ModelBench(const ModelCase& choice) : ModelBench(choice, Setting{}) {}
  ModelBench(const ModelCase& choice, const Setting& setting)
      : mesh(sim::grid_block({0, 0.01, 0.02, 0.03},
                             setting.thin ? std::vector<double>{0, 0.02} : std::vector<double>{0, 0.01, 0.02},
                             {0, 0.012, 0.025})) {
    choice.choose(scene);
    scene.rate_hz = setting.rate_hz;
    scene.deformation.rayleigh_mass = setting.rayleigh_mass;
    scene.deformation.rayleigh_stiffness = setting.rayleigh_stiffness;
    scene.fixed[0].box.reset();  // a ball turns with the scene: this one is so large that it is flat
    scene.fixed[0].ball = sim::Ball{setting.place * Vec3(0.015, 0.01, -10), 10.001};
    for (Vec3& x : mesh.vertices) x = setting.place * x;
    surface = sim::boundary_surface(mesh);
    fixed = sim::fixed_vertices(scene, mesh);
    for (int v = 0; v < size(); ++v) reachable.push_back(v);
    model = choice.row.make({scene, mesh, surface, fixed, reachable, [](std::string_view, double) {}});
  }
  int size() const { return static_cast<int>(surface.vertices.size()); }
  const Vec3& rest(int v) const { return mesh.vertices[surface.vertices[v]]; }

  /// Where one step under these loads leads, looked at again until all is said.
  std::vector<Vec3> step(std::span<const sim::NodalLoad> loads) {
    model->free_motion(1 / scene.rate_hz);
    std::span<const Vec3> moved = model->apply(loads);
    while (model->relinearise()) moved = model->apply(loads);
    return {moved.begin(), moved.end()};
  }
  /// By surface vertices, m/N.
  Eigen::MatrixXd compliance(std::span<const int> vertices) const {
    ContactPatch patch;
    const auto m = static_cast<int>(vertices.size());
    patch.reserve(m, 1);
    model->compliance(vertices, patch);
    return patch.compliance.topLeftCorner(3 * m, 3 * m);
  }
  double largest_way(std::span<const Vec3> positions) const {
    double most = 0;
    for (int v = 0; v < size(); ++v) most = std::max(most, (positions[v] - rest(v)).norm());
    return most;
  }
};

inline double largest_difference(std::span<const Vec3> a, std::span<const Vec3> b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}

}  // namespace palpate::test
