#pragma once
/// A small body with a deformation model on it, to be loaded by hand.
#include <Eigen/Geometry>
#include <algorithm>

#include "sim_server/elasticity/solid.h"
#include "sim_server/tissue/rayleigh_damping.h"
#include "tests/support/model_cases.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"

namespace palpate::test {

/// A small block, or bar, held at its bottom, z = 0, with one model on it. All of its surface is in reach.
struct ModelBench {
  struct Setting {
    Eigen::Isometry3d place = Eigen::Isometry3d::Identity();  ///< where the whole scene is
    bool thin = false;                                        ///< a bar with no node inside
    double rate_hz = 1000, rayleigh_mass = 10, rayleigh_stiffness = 1e-4;
  };
  sim::TetMesh mesh;
  sim::Surface surface;
  sim::Scene scene = scene_of({8e3, 0.4, 1000}, {Vec3(-1, -1, -1), Vec3(1, 1, 0)}, 0.005);
  std::vector<int> fixed, reachable;
  std::unique_ptr<sim::DeformationModel> model;
  sim::ModelTraits traits;

  explicit ModelBench(const ModelCase& choice) : ModelBench(choice, Setting{}) {}
  ModelBench(const ModelCase& choice, const Setting& setting) {
    choice.choose(scene);
    if (auto& fibres = scene.material->fibres) fibres->direction = setting.place.linear() * fibres->direction;
    const std::array<Vec3, 3> corners{Vec3(0, 0, 0), Vec3(0.03, 0, 0), Vec3(0.01, 0.025, 0)};
    mesh =
        with_nodes(setting.thin ? triangular_bar(corners, 0.025, 3)
                                : sim::grid_block({0, 0.01, 0.02, 0.03}, {0, 0.01, 0.02}, {0, 0.012, 0.025}),
                   choice.element);
    scene.rate_hz = setting.rate_hz;
    scene.deformation.of<sim::RayleighDamping>().mass = setting.rayleigh_mass;
    scene.deformation.of<sim::RayleighDamping>().stiffness = setting.rayleigh_stiffness;
    scene.fixed[0].box.reset();  // a ball turns with the scene: this one is so large that it is flat
    scene.fixed[0].ball = sim::Ball{setting.place * Vec3(0.015, 0.01, -10), 10.001};
    if (scene.cutting)
      scene.cutting->region = sim::Region{.ball = sim::Ball{setting.place * Vec3(10.015, 0.01, 0.01), 10}};
    for (Vec3& x : mesh.vertices) x = setting.place * x;
    surface = sim::boundary_surface(mesh);
    fixed = sim::fixed_vertices(scene, mesh);
    for (int v = 0; v < size(); ++v) reachable.push_back(v);
    model = choice.row.make({scene, mesh, surface, fixed, reachable, [](std::string_view, double) {}});
    traits = model->traits();
  }
  int size() const { return static_cast<int>(surface.vertices.size()); }
  const Vec3& rest(int v) const { return mesh.vertices[surface.vertices[v]]; }

  /// Where the next of the instants of a step leads under these loads, looked at again until all is said.
  std::span<const Vec3> instant(std::span<const VertexLoad> loads) {
    model->free_motion(1 / scene.rate_hz / traits.instants);
    std::span<const Vec3> moved = model->apply(loads);
    while (traits.nonlinear && traits.nonlinear->relinearise()) moved = model->apply(loads);
    return moved;
  }
  /// Where one step under these loads leads.
  std::vector<Vec3> step(std::span<const VertexLoad> loads) {
    for (int i = 1; i < traits.instants; ++i) instant(loads);
    const std::span<const Vec3> moved = instant(loads);
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
