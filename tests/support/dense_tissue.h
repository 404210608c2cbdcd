#pragma once
#include <Eigen/Eigenvalues>

#include "sim_server/elasticity/element.h"
#include "sim_server/elasticity/tensors.h"

namespace palpate::test {

/// Stiffness, masses and modes of a small tissue, dense, element by element: what `ElasticTensors` and all
/// that moves by them is held against. Numbers are those of the tensors: three for each free vertex.
struct DenseTissue {
  Eigen::MatrixXd stiffness;  ///< N/m
  Eigen::VectorXd mass;       ///< kg, of each number
  Eigen::VectorXd squares;    ///< angular frequencies squared, rad^2/s^2, ascending
  Eigen::MatrixXd modes;      ///< columns, with mode^T M mode = 1

  DenseTissue(const sim::TetMesh& mesh, const sim::Material& material, const sim::ElasticTensors& tensors) {
    const int n = 3 * tensors.vertices();
    stiffness = Eigen::MatrixXd::Zero(n, n);
    mass = Eigen::VectorXd::Zero(n);
    for (const sim::Tetrahedron& t : mesh.tetrahedra) {
      const auto& x = mesh.vertices;
      const sim::LinearTetrahedron element({x[t[0]], x[t[1]], x[t[2]], x[t[3]]});
      for (int a = 0; a < 4; ++a) {
        const int i = 3 * tensors.places()[t[a]];
        if (i < 0) continue;
        mass.segment<3>(i).array() += material.density * element.volume / 4;
        for (int b = 0; b < 4; ++b) {
          const int j = 3 * tensors.places()[t[b]];
          if (j >= 0) stiffness.block<3, 3>(i, j) += element.stiffness_block(a, b, material);
        }
      }
    }
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(stiffness, mass.asDiagonal());
    squares = solver.eigenvalues();
    modes = solver.eigenvectors();
  }
  double highest() const { return std::sqrt(squares[squares.size() - 1]); }  ///< rad/s
};

}  // namespace palpate::test
