#pragma once
#include <Eigen/Core>

#include "common/types.h"

/// Eigen's dense solvers and decompositions, compiled once for all tests: parsing and instantiating one of
/// them costs the compiler one to six seconds in each test that calls it.
namespace palpate::test {

/// The rotation by the least angle that turns `from` (of any length) to `to`.
Quat turn_between(const Vec3& from, const Vec3& to);
/// A^-1 B by Cholesky's method; A symmetric and positive definite.
Eigen::MatrixXd solve_definite(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
bool is_definite(const Eigen::MatrixXd& a);
/// A^-1 B by elimination with partial pivoting.
Eigen::MatrixXd solve_any(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
Eigen::MatrixXcd solve_any(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b);
/// The x of least norm, of those that leave |A x - B| least.
Eigen::MatrixXd solve_least(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
/// Eigenvalues of a symmetric matrix, ascending.
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& a);
/// exp(A t) x, by eigenvectors: where x goes in time t by x' = A x.
Eigen::VectorXd solution_at(double t, const Eigen::MatrixXd& a, const Eigen::VectorXd& x);
/// Singular values, descending.
Eigen::VectorXd singular_values(const Eigen::MatrixXd& a);
/// Orthonormal columns that span those of A (n x k, k <= n), by Householder's method.
Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& a);

/// K x = square M x, with x^T M x = 1.
struct DenseModes {
  Eigen::VectorXd squares;  ///< ascending
  Eigen::MatrixXd shapes;   ///< columns
};
DenseModes dense_modes(const Eigen::MatrixXd& stiffness, const Eigen::VectorXd& masses);

}  // namespace palpate::test
