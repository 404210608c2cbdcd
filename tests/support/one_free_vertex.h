#pragma once
#include <Eigen/Eigenvalues>

#include "sim_server/elasticity/solid.h"
#include "sim_server/mesh/shapes.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"

namespace palpate::test {

/// A block of which one vertex is free, in the middle of its top, at the origin: an oscillator of one mass,
/// with the softest direction that what holds it has.
struct OneFreeVertex {
  sim::TetMesh mesh = sim::grid_block({-0.01, 0, 0.01}, {-0.01, 0}, {-0.01, 0, 0.01});
  sim::Scene scene = scene_of({.young_modulus = 5e3, .poisson_ratio = 0.3, .density = 1000},
                              {Vec3(-1, -1, -1), Vec3(1, -0.005, 1)}, 0.005);
  int vertex = 0;
  double stiffness = 0, mass = 0, frequency = 0;  // N/m along the direction, kg, rad/s
  Vec3 direction;

  OneFreeVertex() {
    using sim::Box;
    for (const double side : {-1.0, 1.0}) {
      scene.fixed.push_back({{Box{Vec3(side - 0.995, -1, -1), Vec3(side + 0.995, 1, 1)}, "", "test"}});
      scene.fixed.push_back({{Box{Vec3(-1, -1, side - 0.995), Vec3(1, 1, side + 0.995)}, "", "test"}});
    }
    while (mesh.vertices[vertex].norm() > 1e-9) ++vertex;
    const sim::Solid solid(mesh, *scene.material);
    Mat3 k;
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<Vec3> x = solid.rest(), f(x.size());
      x[vertex] += Vec3::Unit(axis);
      solid.forces(x, f);
      k.col(axis) = f[vertex];
    }
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(k);
    direction = eigen.eigenvectors().col(0);
    stiffness = eigen.eigenvalues()[0];
    mass = solid.masses()[vertex];
    frequency = std::sqrt(stiffness / mass);
  }
};

}  // namespace palpate::test
