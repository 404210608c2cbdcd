#include "sim_server/solvers/newton_factor.h"

#include <cmath>
#include <utility>

namespace palpate::sim {
namespace {

// Relative residual at which a step no longer counts as solved (`Implicit`): the next step takes another
// factor, of the background, or in place of a bordered one.
constexpr double kUnbalanced = 0.01;

double largest_distance(std::span<const Vec3> a, std::span<const Vec3> b) {
  double squared = 0;
  for (std::size_t i = 0; i < a.size(); ++i) squared = std::max(squared, (a[i] - b[i]).squaredNorm());
  return std::sqrt(squared);
}

}  // namespace

NewtonFactor::NewtonFactor(const Solid& solid, const EquationsOfMotion& motion,
                           const DynamicsSettings& dynamics, const Settings& settings,
                           const std::string& where)
    : solid_(&solid),
      matrix_(solid, motion.dofs(), dynamics, where),
      settings_(settings),
      policy_({.background = settings.background,
               .refresh_steps = dynamics.refresh_steps,
               .negligible_force = settings.negligible_distance * matrix_.mean_diagonal()}) {
  if (settings.background) background_.emplace(solid, motion.dofs(), dynamics, where);
}

void NewtonFactor::start_step(EquationsOfMotion& motion, bool damped, double relative_residual) {
  quasi_newton_.restart();
  if (policy_.start(motion.time().steps(), damped, relative_residual > kUnbalanced)) exchange(motion);
  matrix_.turn_to(*solid_, motion.position());
  matrix_.make_border(*solid_, motion.masses());
  const bool serves_badly = matrix_.is_bordered() && relative_residual > kUnbalanced;
  if (matrix_.border_misfits() || serves_badly) matrix_.expire();
}

bool NewtonFactor::match_step_length(EquationsOfMotion& motion) {
  if (matrix_.c() == motion.time().c()) return false;
  factor(motion);
  policy_.replaced();
  return true;
}

bool NewtonFactor::prepare(EquationsOfMotion& motion, const Residual& residual, double previous,
                           bool just_factored) {
  using Decision = FactorPolicy::Decision;
  const Decision decision = policy_.decide(residual, previous, just_factored);
  if (decision == Decision::kRefactorChecked) matrix_.check_precision();
  if (decision == Decision::kRefactor || decision == Decision::kRefactorChecked) factor(motion);
  return decision != Decision::kStop;
}

void NewtonFactor::factor(EquationsOfMotion& motion) {
  matrix_.build(*solid_, motion.position(), motion.masses(), motion.viscosity(), motion.time().c(),
                motion.scratch());
  factored_at_.assign(motion.position().begin(), motion.position().end());
  from_background_ = cut_since_factored_ = false;
  count_new();
}

void NewtonFactor::count_new() {
  quasi_newton_.clear();
  ++count_;
}

void NewtonFactor::refactor_if_moved(EquationsOfMotion& motion) {
  if (background_) return;
  if (!cut_since_factored_ && largest_distance(motion.position(), factored_at_) <= settings_.remote_distance)
    return;
  factor(motion);
  policy_.replaced();
}

/// Takes the factor that the background has made, if it made one, and has it begin the next from where the
/// body is now.
void NewtonFactor::exchange(EquationsOfMotion& motion) {
  if (background_->begun() && background_->exchange(matrix_)) {
    from_background_ = true;
    count_new();
    policy_.replaced();
  }
  background_->begin(motion.time().position(), motion.masses(), motion.viscosity(), motion.time().c(),
                     requested_columns_);
}

void NewtonFactor::remove(std::span<const int> tetrahedra) {
  if (background_) background_->remove(tetrahedra);
  note_cut();
}

void NewtonFactor::note_shapes(EquationsOfMotion& motion, std::span<const int> tetrahedra) {
  for (const int t : tetrahedra) {
    NewtonMatrix::Blocks blocks;
    auto* block = blocks.data();
    solid_->stiffness_of(static_cast<std::size_t>(t), motion.position(), motion.viscosity(), motion.scratch(),
                         [&](int i, int j, const Mat3& k) { *block++ = matrix_.to_rest(i, j, k); });
    matrix_.note_shape(t, blocks);
    if (background_) background_->note_shape(t, blocks);
  }
}

void NewtonFactor::part(std::span<const Split> splits) {
  matrix_.part(splits);
  if (background_) background_->part(splits);
  note_cut();
  from_background_ = false;  // its columns are of nodes that were one
  count_new();
}

void NewtonFactor::note_cut() {
  cut_since_factored_ = true;
  quasi_newton_.clear();
  policy_.replaced();
}

const Columns& NewtonFactor::background_columns() const {
  static const Columns none;
  return from_background_ ? background_->columns() : none;
}

std::size_t NewtonFactor::bytes() const {
  return matrix_.bytes() + factored_at_.size() * sizeof(Vec3) + (background_ ? background_->bytes() : 0);
}

}  // namespace palpate::sim
