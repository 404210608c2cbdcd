#include "sim_server/sparse/dense_spectra.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "sim_server/sparse/blas.h"

namespace palpate::sim {
namespace {

/// Calls a routine of LAPACK twice: for the sizes of its work space, and to compute. Returns whether it did.
template <class Routine>
bool call_with_work_space(const Routine& routine) {
  double size = 0;
  int integers = 0, info = 0;
  const int ask = -1;
  routine(&size, &ask, &integers, &ask, &info);
  if (info != 0) return false;
  std::vector<double> work(static_cast<std::size_t>(std::max(size, 1.0)));
  std::vector<int> integer_work(static_cast<std::size_t>(std::max(integers, 1)));
  const int length = static_cast<int>(work.size()), integer_length = static_cast<int>(integer_work.size());
  routine(work.data(), &length, integer_work.data(), &integer_length, &info);
  return info == 0;
}

/// Eigenvalues in rising order and, where `what` is "V" and not "N", the eigenvectors in place of `a`.
bool find_eigenvalues(const char* what, Eigen::MatrixXd& a, Eigen::VectorXd& values) {
  const int n = static_cast<int>(a.rows());
  values.resize(n);
  return call_with_work_space(
      [&](double* work, const int* length, int* integers, const int* count, int* info) {
        dsyevd_(what, "L", &n, a.data(), &n, values.data(), work, length, integers, count, info);
      });
}

}  // namespace

std::optional<ThinSvd> thin_svd(Eigen::MatrixXd matrix) {
  const int rows = static_cast<int>(matrix.rows()), columns = static_cast<int>(matrix.cols()),
            least = std::min(rows, columns);
  ThinSvd svd{Eigen::MatrixXd(rows, least), Eigen::VectorXd(least), Eigen::MatrixXd(least, columns)};
  std::vector<int> pivots(8 * static_cast<std::size_t>(least));
  const auto routine = [&](double* work, const int* length, int*, const int*, int* info) {
    dgesdd_("S", &rows, &columns, matrix.data(), &rows, svd.singular_values.data(), svd.left.data(), &rows,
            svd.right_transpose.data(), &least, work, length, pivots.data(), info);
  };
  if (!call_with_work_space(routine)) return {};
  return svd;
}

std::optional<SymmetricSpectrum> symmetric_spectrum(Eigen::MatrixXd a) {
  SymmetricSpectrum spectrum;
  if (!find_eigenvalues("V", a, spectrum.values)) return {};
  spectrum.vectors = std::move(a);
  return spectrum;
}

double largest_eigenvalue(Eigen::MatrixXd a) {
  Eigen::VectorXd values;
  if (!find_eigenvalues("N", a, values)) return std::numeric_limits<double>::quiet_NaN();
  return values[values.size() - 1];
}

std::optional<SymmetricSpectrum> symmetric_spectrum(Eigen::MatrixXd a, Eigen::MatrixXd b) {
  const int n = static_cast<int>(a.rows()), a_v_is_lambda_b_v = 1;
  SymmetricSpectrum spectrum{Eigen::VectorXd(n), {}};
  const auto routine = [&](double* work, const int* length, int* integers, const int* count, int* info) {
    dsygvd_(&a_v_is_lambda_b_v, "V", "L", &n, a.data(), &n, b.data(), &n, spectrum.values.data(), work,
            length, integers, count, info);
  };
  if (!call_with_work_space(routine)) return {};
  spectrum.vectors = std::move(a);
  return spectrum;
}

}  // namespace palpate::sim
