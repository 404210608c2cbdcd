#pragma once
#include "sim_server/elasticity/tensors.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/stiffness.h"

namespace palpate::test {

/// Stiffness, masses and modes of a small tissue, dense, from the body as a `Solid`: what `ElasticTensors`
/// and all that moves by them is held against. Numbers are those of the tensors: three for each free vertex.
struct DenseTissue {
  Eigen::MatrixXd stiffness;  ///< N/m
  Eigen::VectorXd mass;       ///< kg, of each number
  Eigen::VectorXd squares;    ///< angular frequencies squared, rad^2/s^2, ascending
  Eigen::MatrixXd modes;      ///< columns, with mode^T M mode = 1

  DenseTissue(const sim::TetMesh& mesh, const sim::Material& material, const sim::ElasticTensors& tensors) {
    const int n = 3 * tensors.vertices();
    stiffness = Eigen::MatrixXd::Zero(n, n);
    mass = Eigen::VectorXd::Zero(n);
    const sim::Solid solid(mesh, material);
    const Eigen::MatrixXd all = dense_stiffness(solid, sim::FreeDofs(solid.nodes(), {}));
    const std::vector<double> masses = solid.masses();
    for (int a = 0; a < solid.nodes(); ++a) {
      const int i = 3 * tensors.places()[a];
      if (i < 0) continue;
      mass.segment<3>(i).setConstant(masses[a]);
      for (int b = 0; b < solid.nodes(); ++b) {
        const int j = 3 * tensors.places()[b];
        if (j >= 0) stiffness.block<3, 3>(i, j) = all.block<3, 3>(3 * a, 3 * b);
      }
    }
    const DenseModes dense = dense_modes(stiffness, mass);
    squares = dense.squares;
    modes = dense.shapes;
  }
  double highest() const { return std::sqrt(squares[squares.size() - 1]); }  ///< rad/s
};

}  // namespace palpate::test
