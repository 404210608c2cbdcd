#include "sim_server/solvers/step_costs.h"

#include <fmt/core.h>

namespace palpate::sim {
namespace {

// Of each point of an element, ms.
constexpr double kEvaluation = 80e-6, kAssembly = 0.8e-3;
constexpr double kAveragedAssembly = 5e-3;  // of an element whose dilation is averaged, which ties more nodes
constexpr double kBytes = 20e6;             // of a factor that are read in a ms; a solve reads it twice
constexpr double kSingle = 1e8, kDouble = 6e7;  // multiplications of a factor in a ms

}  // namespace

StepCosts::StepCosts(const Solid& solid, const NewtonMatrix& matrix) {
  const auto points = static_cast<double>(solid.points());
  const bool averages = solid.material().element == ElementKind::kNodalPressure;
  const SparseCholesky& made = matrix.factor();
  const double rate = made.precision() == SparseCholesky::Precision::kSingle ? kSingle : kDouble;
  evaluation = kEvaluation * points;
  solve = 2 * static_cast<double>(made.bytes()) / kBytes;
  factor = (averages ? kAveragedAssembly : kAssembly) * points + made.multiplications() / rate;
}

std::string StepCosts::to_text() const {
  return fmt::format("an evaluation {:.2g}, a solve {:.2g}, the columns of a node {:.2g}, a factor {:.2g} ms",
                     evaluation, solve, columns(1), factor);
}

}  // namespace palpate::sim
