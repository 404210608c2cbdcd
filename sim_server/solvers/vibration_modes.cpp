#include "sim_server/solvers/vibration_modes.h"

#include <Spectra/SymEigsSolver.h>

#include "common/error.h"

namespace palpate::sim {
namespace {

/// v -> M^1/2 K^-1 M^1/2 v, as Spectra asks for it.
struct Flexibility {
  using Scalar = double;
  const FactoredMatrix& stiffness;
  const Eigen::VectorXd& root;  // of the masses

  Eigen::Index rows() const { return root.size(); }
  Eigen::Index cols() const { return root.size(); }
  void perform_op(const double* in, double* out) const {
    const Eigen::Map<const Eigen::VectorXd> v(in, root.size());
    Eigen::Map<Eigen::VectorXd> result(out, root.size());
    result = root.cwiseProduct(stiffness.solve(root.cwiseProduct(v)).col(0));
  }
};

}  // namespace

VibrationModes vibration_modes(const FactoredMatrix& stiffness, const Eigen::VectorXd& masses, int count,
                               const std::string& where) {
  const Eigen::Index n = masses.size();
  if (count >= n)
    fail("{}: {} modes asked for, but a body of {} unknowns has fewer to choose from; ask for less", where,
         count, n);
  const Eigen::VectorXd root = masses.cwiseSqrt();
  Flexibility flexibility{stiffness, root};
  Spectra::SymEigsSolver<Flexibility> solver(flexibility, count, std::min<Eigen::Index>(n, 2 * count + 20));
  solver.init();
  solver.compute(Spectra::SortRule::LargestAlge);
  if (solver.info() != Spectra::CompInfo::Successful)
    fail("{}: the {} lowest modes of vibration were not found; ask for less", where, count);
  VibrationModes modes{solver.eigenvalues().cwiseSqrt().cwiseInverse(), solver.eigenvectors(count)};
  for (Eigen::Index k = 0; k < count; ++k) modes.shapes.col(k) = modes.shapes.col(k).cwiseQuotient(root);
  return modes;
}

}  // namespace palpate::sim
