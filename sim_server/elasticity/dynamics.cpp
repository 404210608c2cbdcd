#include "sim_server/elasticity/dynamics.h"

#include <Eigen/LU>
#include <cmath>

#include "sim_server/elasticity/inversion.h"

namespace palpate::sim {
namespace {

// Of what is unbalanced: a step with an old factor that leaves more is a reason to factor anew.
constexpr double kWorthwhile = 0.3;
// Likewise: so little may be rounding, where a fresh factor makes it no less.
constexpr double kRounding = 1e-6;
// Of what a fresh factor made no less: so much is the same rounding, and no reason to factor again.
constexpr double kSame = 2;
// Of the size of the body: what moves a node by less is no force at work, so that a body at rest is at rest.
constexpr double kStill = 1e-9;
constexpr double kMute = 1e-3;  // of such a force: what a fresh factor does not lessen is rounding as well
// Likewise: a factor of a place that far off is of another place.
constexpr double kElsewhere = 1e-4;
// Likewise: by so much nodes are moved to learn how forces change.
constexpr double kNudge = 1e-7;
// Of the forces at work: where the last way of a step leaves more, velocities mean nothing, and it ends at
// rest: each step from there lowers the energy, however far Newton's method is from balance.
constexpr double kAdrift = 0.1;
// Likewise: where no more is unbalanced, and loads change by no more, linearisation is trusted without
// another look at the forces.
constexpr double kCalm = 0.1;
// Of a way that overshoots: the shortest part that is tried.
constexpr double kShortest = 1e-4;
// Conjugate gradients end when no more than this share is left, or after so many.
constexpr double kInexact = 0.1;
constexpr int kMostGradients = 20;

}  // namespace

Dynamics::Dynamics(const Solid& solid, std::vector<HeldAxes> held, const DynamicsSettings& settings,
                   const std::string& where)
    : solid_(solid),
      scratch_(solid),
      settings_(settings),
      dofs_(std::move(held)),
      matrix_(solid, dofs_, settings, where),
      x_(solid.rest()),
      x_before_(x_),
      v_before_(x_.size(), Vec3::Zero()),
      x_then_(x_),
      v_then_(v_before_),
      from_(x_),
      from_v_(v_before_),
      internal_(x_.size(), Vec3::Zero()),
      internal_before_(internal_),
      internal_then_(internal_),
      from_internal_(internal_) {
  Eigen::AlignedBox3d box;
  for (const Vec3& x : x_) box.extend(x);
  reach_ = box.diagonal().norm();
  still_ = kStill * reach_ * matrix_.usual();
  // Of a linear law one factor serves for ever.
  if (settings.solver != DynamicsSettings::Solver::kDirect && solid.material().law != ElasticLaw::kLinear)
    background_.emplace(solid, dofs_, settings, where);
  const std::size_t terms = solid.material().relaxations.size();
  if (terms == 0) return;
  stress_.assign(solid.points(), Mat3::Zero());
  memory_ = stress_;
  terms_.assign(terms * solid.points(), Mat3::Zero());
}

void Dynamics::stand_at(std::vector<Vec3> x, std::vector<Vec3> v) {
  x_ = x_before_ = x_then_ = std::move(x);
  told_ = told_before_ = false;
  if (!v.empty()) v_before_ = std::move(v);
  resist();
  internal_before_ = internal_then_ = internal_;
}

void Dynamics::start_step(double h) {
  h_ = h;
  told_ = false;
  quasi_newton_.begin();
  if (learns()) too_old_ = false;
  improved_ = false;
  remains_ = 0;
  predicted_ = true;
  const bool second = settings_.second_order && steps_ > 0;
  c_ = (second ? 1.5 : 1) / h;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    from_[i] = second ? Vec3((4 * x_before_[i] - x_then_[i]) / 3) : x_before_[i];
    from_v_[i] = second ? Vec3((4 * v_before_[i] - v_then_[i]) / 3) : v_before_[i];
    from_internal_[i] =
        second ? Vec3((4 * internal_before_[i] - internal_then_[i]) / 3) : internal_before_[i];
    if (dofs_.first[i] >= 0) x_[i] = x_before_[i] + h * v_before_[i];
  }
  scale_ = 1;
  if (!terms_.empty()) remember(h);
  if (background_ && steps_ % settings_.refresh_steps == 0 && steps_ != exchanged_) {
    exchanged_ = steps_;
    exchange_factors();
  }
}

/// What is left of the stresses before, at the end of a step of `h`.
void Dynamics::remember(double h) {
  std::fill(memory_.begin(), memory_.end(), Mat3::Zero());
  const auto& relaxations = solid_.material().relaxations;
  for (std::size_t k = 0; k < relaxations.size(); ++k) {
    const auto& [share, time] = relaxations[k];
    const double fade = std::exp(-h / time), gamma = -std::expm1(-h / time) * time / h;
    scale_ += share * (gamma - 1);
    for (std::size_t p = 0; p < memory_.size(); ++p)
      memory_[p] += fade * terms_[k * memory_.size() + p] - share * gamma * stress_[p];
  }
}

Viscosity Dynamics::viscosity() const {
  return {scale_, memory_};
}

void Dynamics::factor() {
  matrix_.build(solid_, x_, viscosity(), c_, scratch_);
  factored_at_ = x_;
  from_background_ = false;
  renewed();
}

void Dynamics::refresh() {
  if (background_) return;
  double farthest = 0;
  for (std::size_t i = 0; i < x_.size(); ++i)
    farthest = std::max(farthest, (x_[i] - factored_at_[i]).squaredNorm());
  if (std::sqrt(farthest) > kElsewhere * reach_) factor();
}

void Dynamics::renewed() {
  too_old_ = false;
  quasi_newton_.forget();
  ++factors_;
}

/// Takes the factor that the background has made, and has it begin the next from where the body is now.
void Dynamics::exchange_factors() {
  if (background_->begun()) {
    background_->take(matrix_);
    from_background_ = true;
    renewed();
  }
  background_->begin(x_before_, viscosity(), c_, foreseen_);
}

const Columns& Dynamics::foreseen() const {
  static const Columns none;
  return from_background_ ? background_->columns() : none;
}

/// f_int where the body is looked for now.
void Dynamics::resist() {
  if (!told_) solid_.forces(x_, internal_, viscosity(), scratch_);
  told_ = true;
}

/// f_ext less all the rest, over the unknowns, N.
Eigen::VectorXd Dynamics::imbalance(std::span<const Vec3> external) {
  resist();
  const double alpha = settings_.rayleigh_mass, damped = settings_.rayleigh_stiffness * c_;
  const std::vector<double>& mass = matrix_.masses();
  Eigen::VectorXd left(dofs_.count);
  double at_work = still_ * still_;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const Vec3 v = c_ * (x_[i] - from_[i]), inertia = mass[i] * (c_ * (v - from_v_[i]) + alpha * v);
    at_work += internal_[i].squaredNorm() + external[i].squaredNorm() + inertia.squaredNorm();
    if (dofs_.first[i] < 0) continue;
    left.segment<3>(dofs_.first[i]) =
        external[i] - internal_[i] - damped * (internal_[i] - from_internal_[i]) - inertia;
  }
  dofs_.hold(left);
  at_work_ = std::sqrt(at_work);
  left_ = left.norm() / at_work_;
  seen_.assign(external.begin(), external.end());
  return left;
}

void Dynamics::move(const Eigen::VectorXd& by) {
  told_ = false;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    if (dofs_.first[i] >= 0) x_[i] += by.segment<3>(dofs_.first[i]);
  }
}

double Dynamics::improve(std::span<const Vec3> external, double tolerance) {
  const double before = left_;
  if (predicted_) shorten_prediction(external);
  bool fresh = matrix_.c() != c_;
  if (fresh) factor();
  Eigen::VectorXd left = imbalance(external);
  if (!std::isfinite(left_)) {  // flung about beyond all measure: it stays where it was
    x_ = x_before_;
    told_ = false;
    left_ = remains_ = 1;
    return 0;
  }
  if (left_ <= tolerance) return left_;
  if (left_ * at_work_ <= kSame * rounding_) return 0;
  bool slow = false;
  if (improved_ && left_ > kWorthwhile * before) {
    if (fresh_ && (left_ <= kRounding || left_ * at_work_ <= kMute * still_)) {
      rounding_ = left_ * at_work_;
      return 0;
    }
    slow = true;
    if (!background_) {
      if (fresh_) matrix_.check_precision();
      factor();
      fresh = true;
      left = imbalance(external);
    }
  }
  improved_ = true;
  if (learns()) learn(left, external);
  too_old_ = too_old_ || slow;
  fresh_ = fresh || too_old_;
  Eigen::VectorXd way =
      background_ && too_old_ ? conjugate_gradients(left, external) : quasi_newton_.step(matrix_, left);
  if (!way.allFinite()) way = left / matrix_.largest();  // there is no factor: a little the right way
  if (wary_ || left_ > kCalm) {
    go(way, left, external);
  } else {
    move(way);
    remains_ = left_;
  }
  return left_;
}

void Dynamics::follow(const Eigen::VectorXd& way, std::span<const Vec3> external) {
  if (never_changes()) return move(way);
  double changed = 0;
  for (std::size_t i = 0; i < seen_.size(); ++i) changed += (external[i] - seen_[i]).squaredNorm();
  if (!wary_ && left_ <= kCalm && std::sqrt(changed) <= kCalm * at_work_) return move(way);
  const double unbalanced_before = left_;
  const Eigen::VectorXd left = imbalance(external);
  go(way, left, external);
  left_ = unbalanced_before;
}

/// Along `way` (m) from where `left` is unbalanced: all of it, or a half, a quarter ... of it, so that what
/// is unbalanced there does not pull back harder. Forces that grow faster than their linearisation would else
/// throw the body farther each time.
void Dynamics::go(const Eigen::VectorXd& way, const Eigen::VectorXd& left, std::span<const Vec3> external) {
  if (never_changes()) return move(way);
  const double unbalanced_here = left_, pull = std::abs(left.dot(way));
  const std::vector<Vec3> here = x_;
  remains_ = 1;
  for (double length = 1; remains_ == 1 && length > kShortest; length /= 2) {
    x_ = here;
    move(length * way);
    if (imbalance(external).dot(way) >= -pull) remains_ = left_;
  }
  if (remains_ == 1) x_ = here;
  told_ = told_ && remains_ < 1;
  left_ = unbalanced_here;
}

/// Where the velocity leads; since a step that ended far from balance, and until the body rests, only as far
/// as elastic forces would not turn it on the way.
void Dynamics::shorten_prediction(std::span<const Vec3> external) {
  predicted_ = false;
  if (never_changes() || !wary_) return;
  Eigen::VectorXd way(dofs_.count);
  for (std::size_t i = 0; i < x_.size(); ++i) {
    if (dofs_.first[i] < 0) continue;
    way.segment<3>(dofs_.first[i]) = h_ * v_before_[i];
    x_[i] = x_before_[i];
  }
  told_ = told_before_ && terms_.empty();
  if (told_) internal_ = internal_before_;
  dofs_.hold(way);
  go(way, imbalance(external), external);
}

/// How the body resists where it is now.
void Dynamics::learn(const Eigen::VectorXd& left, std::span<const Vec3> external) {
  Eigen::VectorXd place = Eigen::VectorXd::Zero(dofs_.count), resistance = -left;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    if (dofs_.first[i] < 0) continue;
    place.segment<3>(dofs_.first[i]) = x_[i];
    resistance.segment<3>(dofs_.first[i]) += external[i];
  }
  dofs_.hold(resistance);
  quasi_newton_.learn(place, resistance);
}

/// A way by which the body moves towards balance, m: A^-1 `left` to within a share of it, of A here and now.
Eigen::VectorXd Dynamics::conjugate_gradients(const Eigen::VectorXd& left, std::span<const Vec3> external) {
  const double enough = kInexact * left.norm();
  Eigen::VectorXd way = Eigen::VectorXd::Zero(left.size()), rest = left, along = way;
  double before = 1;
  for (int i = 0; i < kMostGradients && rest.norm() > enough; ++i) {
    const Eigen::VectorXd ahead = quasi_newton_.step(matrix_, rest);
    const double now = rest.dot(ahead);
    along = ahead + now / before * along;
    before = now;
    const Eigen::VectorXd pull = stiffness_times(along, left, external);
    const double bend = along.dot(pull);
    if (!(bend > 0)) return i == 0 ? along : way;  // about to buckle: as far as it goes
    way += now / bend * along;
    rest -= now / bend * pull;
  }
  return way;
}

/// A `way`, N, of A here and now, where `left` is unbalanced.
Eigen::VectorXd Dynamics::stiffness_times(const Eigen::VectorXd& way, const Eigen::VectorXd& left,
                                          std::span<const Vec3> external) {
  const double share = kNudge * reach_ / way.cwiseAbs().maxCoeff(), unbalanced_here = left_;
  const std::vector<Vec3> here = x_;
  move(share * way);
  Eigen::VectorXd change = (left - imbalance(external)) / share;
  x_ = here;
  told_ = false;
  left_ = unbalanced_here;
  return change;
}

int Dynamics::settle(std::span<const Vec3> external, int most, double tolerance) {
  int steps = 0;
  while (steps < most && improve(external, tolerance) > tolerance) ++steps;
  return steps;
}

void Dynamics::finish_step() {
  if (settings_.rayleigh_stiffness > 0) resist();
  told_before_ = told_;
  std::swap(internal_then_, internal_before_);
  std::swap(internal_before_, internal_);
  told_ = false;
  if (!terms_.empty()) relax_stress(h_);
  const bool adrift = remains_ > kAdrift;
  wary_ = adrift || (wary_ && left_ > kRounding);
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const Vec3 v = adrift ? Vec3(Vec3::Zero()) : Vec3(c_ * (x_[i] - from_[i]));
    x_then_[i] = adrift ? x_[i] : x_before_[i];
    v_then_[i] = adrift ? v : v_before_[i];
    x_before_[i] = x_[i];
    v_before_[i] = v;
  }
  ++steps_;
}

void Dynamics::relax_stress(double h) {
  std::vector<Solid::State> states(solid_.points());
  solid_.evaluate(x_, states, {}, scratch_);
  const bool linear = solid_.material().law == ElasticLaw::kLinear;
  const auto& relaxations = solid_.material().relaxations;
  for (std::size_t p = 0; p < states.size(); ++p) {
    const Mat3 now = linear ? states[p].stress : Mat3(states[p].F.inverse() * states[p].stress);
    if (!now.allFinite()) continue;  // turned flat: it remembers what was
    for (std::size_t k = 0; k < relaxations.size(); ++k) {
      const auto& [share, time] = relaxations[k];
      const double gamma = -std::expm1(-h / time) * time / h;
      Mat3& term = terms_[k * states.size() + p];
      term = std::exp(-h / time) * term + share * gamma * (now - stress_[p]);
    }
    stress_[p] = now;
  }
}

void Dynamics::forces(std::span<Vec3> f) const {
  solid_.forces(x_, f, viscosity());
}

bool Dynamics::inside_out() const {
  return may_stay_inverted(solid_.material()) && any_inverted(solid_, x_);
}

void Dynamics::resistance(std::span<Vec3> f) const {
  solid_.forces(x_, f, viscosity());
  const double alpha = settings_.rayleigh_mass, damped = settings_.rayleigh_stiffness * c_;
  const std::vector<double>& mass = matrix_.masses();
  for (std::size_t i = 0; i < f.size(); ++i) {
    const Vec3 v = c_ * (x_[i] - from_[i]);
    if (damped > 0) f[i] += damped * (f[i] - from_internal_[i]);
    f[i] += mass[i] * (c_ * (v - from_v_[i]) + alpha * v);
  }
}

double Dynamics::kinetic_energy() const {
  double sum = 0;
  const std::vector<double>& mass = matrix_.masses();
  for (std::size_t i = 0; i < mass.size(); ++i) sum += 0.5 * mass[i] * v_before_[i].squaredNorm();
  return sum;
}

std::size_t Dynamics::bytes() const {
  return (x_.size() * 8) * sizeof(Vec3) + matrix_.bytes() +
         (stress_.size() + memory_.size() + terms_.size()) * sizeof(Mat3) +
         (background_ ? background_->bytes() : 0);
}

}  // namespace palpate::sim
