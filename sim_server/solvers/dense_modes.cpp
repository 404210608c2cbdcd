#include "sim_server/solvers/dense_modes.h"

#include <algorithm>

#include "sim_server/sparse/blas.h"

namespace palpate::sim {

std::optional<DenseModes> dense_modes(Eigen::MatrixXd stiffness, Eigen::MatrixXd masses) {
  constexpr int kOfMasses = 1;  // K phi = lambda M phi, of the three problems that LAPACK knows
  constexpr int kPanels = 66;   // columns of its work space: two more than it takes together
  const int n = static_cast<int>(stiffness.rows()), lead = std::max(n, 1), work_size = kPanels * lead;
  Eigen::VectorXd values(n), work(work_size);
  int info = 0;
  Blas<double>::sygv(&kOfMasses, "V", "L", &n, stiffness.data(), &lead, masses.data(), &lead, values.data(),
                     work.data(), &work_size, &info);
  if (info != 0) return {};
  return DenseModes{std::move(values), std::move(stiffness)};
}

}  // namespace palpate::sim
