#pragma once
#include <Eigen/Core>
#include <optional>

namespace palpate::sim {

/// Factors of a dense matrix A = U S V^T.
struct ThinSvd {
  Eigen::MatrixXd left;             ///< U, rows x min(rows, columns)
  Eigen::VectorXd singular_values;  ///< the diagonal of S, in falling order
  Eigen::MatrixXd right_transpose;  ///< V^T, min(rows, columns) x columns
};

/// Returns the thin singular value decomposition, by LAPACK's dgesdd; nothing where it does not converge.
/// `matrix` has a row and a column at least.
std::optional<ThinSvd> thin_svd(Eigen::MatrixXd matrix);

/// Eigenvalues in rising order, and the eigenvector of each as a column.
struct SymmetricSpectrum {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

/// Solves A v = lambda v for a symmetric A, of which the lower triangle is read, by LAPACK's dsyevd; nothing
/// where it does not converge.
std::optional<SymmetricSpectrum> symmetric_spectrum(Eigen::MatrixXd a);

/// Returns the largest eigenvalue of a symmetric matrix, of which the lower triangle is read; not a number
/// where it does not converge.
double largest_eigenvalue(Eigen::MatrixXd a);

/// Solves A v = lambda B v, with v^T B v = 1, for a symmetric A and a symmetric positive-definite B, of which
/// the lower triangles are read, by LAPACK's dsygvd; nothing where B is not definite or it does not converge.
std::optional<SymmetricSpectrum> symmetric_spectrum(Eigen::MatrixXd a, Eigen::MatrixXd b);

}  // namespace palpate::sim
