// What Newton's method is made of, against closed forms: a line search, conjugate gradients, and products
// with a Jacobian that is not assembled.
#include "sim_server/solvers/newton.h"

#include "tests/support/catch.h"
#include "tests/support/dense_algebra.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

Eigen::VectorXd one(double value) {
  return Eigen::VectorXd::Constant(1, value);
}

/// A spring r(x + s d) = 1 - (s / s0)^3, which balances at s0 of the direction.
ResidualAlong cubic(double balance, int* calls = nullptr) {
  return [balance, calls](double s) {
    if (calls != nullptr) ++*calls;
    const double force = 1 - std::pow(s / balance, 3);
    return Residual{one(force), 2, std::abs(force) / 2};
  };
}

Eigen::MatrixXd with_spectrum(const Eigen::VectorXd& values) {
  const Eigen::MatrixXd noise = Eigen::MatrixXd::Random(values.size(), values.size());
  const Eigen::MatrixXd q = test::orthonormal(noise);
  return q * values.asDiagonal() * q.transpose();
}

LinearMap product(const Eigen::MatrixXd& a, int* calls = nullptr) {
  return [&a, calls](const Eigen::VectorXd& v) -> Eigen::VectorXd {
    if (calls != nullptr) ++*calls;
    return a * v;
  };
}

const Eigen::MatrixXd& identity() {
  static const Eigen::MatrixXd i = Eigen::MatrixXd::Identity(12, 12);
  return i;
}

}  // namespace

TEST_CASE("Newton's method: an iteration goes where the tangent leads, and says how it ended") {
  using End = NewtonIteration::End;
  // r(x) = 8 - x^3 from x = 3: the tangent crosses zero at 3 - 19 / 27.
  double x = 3;
  const NewtonProblem spring{
      .residual =
          [&] {
            return Residual{one(8 - x * x * x), 8, std::abs(8 - x * x * x) / 8};
          },
      .direction = [&](const Residual& r) { return std::optional(one(r.force[0] / (3 * x * x))); },
      .accept =
          [&](const Eigen::VectorXd& d, const Residual&) {
            x += d[0];
            return true;
          }};
  const NewtonIteration first = iterate_newton(spring, 1e-9);
  CHECK(first.end == End::kMoved);
  CHECK(first.relative == Approx(19.0 / 8));
  CHECK(x == Approx(3 - 19.0 / 27).epsilon(1e-14));
  for (int i = 0; i < 6; ++i) iterate_newton(spring, 1e-9);
  CHECK(iterate_newton(spring, 1e-9).end == End::kBalanced);
  CHECK(x == Approx(2).epsilon(1e-9));
  NewtonProblem stuck = spring;
  x = 3;
  stuck.accept = [](const Eigen::VectorXd&, const Residual&) { return false; };
  CHECK(iterate_newton(stuck, 1e-9).end == End::kNotAccepted);
  stuck.direction = [](const Residual&) { return std::optional<Eigen::VectorXd>(); };
  CHECK(iterate_newton(stuck, 1e-9).end == End::kNoDirection);
  x = 1e300;
  CHECK(iterate_newton(spring, 1e-9).end == End::kNotFinite);
  CHECK(x == 1e300);
}

TEST_CASE("newton: the line search halves until the spring pulls back no harder than it was pushed") {
  // (s / s0)^3 <= 2 is what it asks for.
  for (const auto& [balance, length] : {std::pair{1.0, 1.0}, {0.8, 1.0}, {0.79, 0.5}, {0.1, 0.125}}) {
    int calls = 0;
    const TrialStep trial = line_search(one(1), one(1), cubic(balance, &calls));
    CAPTURE(balance);
    CHECK(trial.length == length);
    CHECK(trial.relative == Approx(std::abs(1 - std::pow(length / balance, 3)) / 2));
    CHECK(calls == 1 + static_cast<int>(std::lround(-std::log2(length))));
  }
}

TEST_CASE("newton: a line search gives up below 1e-4, and accepts no step where nothing answers the load") {
  int calls = 0;
  const TrialStep none = line_search(one(1), one(1), cubic(1e-6, &calls));
  CHECK(none.length == 0);
  CHECK(none.relative == 1);
  CHECK(calls == 14);  // 2^-13 > 1e-4
  const auto unanswered = [](double s) { return Residual{one(1), 1, s > 0.3 ? 1 : 0.5}; };
  CHECK(line_search(one(1), one(1), unanswered).length == 0.25);
  const auto no_number = [](double s) { return Residual{one(s > 0.3 ? std::nan("") : 0), 1, 0}; };
  CHECK(line_search(one(1), one(1), no_number).length == 0.25);
}

TEST_CASE("newton: conjugate gradients solve in as many iterations as A has eigenvalues") {
  Eigen::VectorXd values(12);
  values << 1, 1, 1, 1, 5, 5, 5, 5, 5, 40, 40, 40;
  const Eigen::MatrixXd a = with_spectrum(values);
  const Eigen::VectorXd b = Eigen::VectorXd::Random(12), exact = test::solve_definite(a, b);
  int calls = 0;
  Eigen::VectorXd x = conjugate_gradients(b, product(a, &calls), product(identity()), {1e-11, 20});
  CHECK(calls == 3);
  CHECK((x - exact).norm() < 1e-9 * exact.norm());
  // With A^-1 for preconditioner, one.
  calls = 0;
  const Eigen::MatrixXd inverse = test::solve_definite(a, Eigen::MatrixXd::Identity(a.rows(), a.cols()));
  x = conjugate_gradients(b, product(a, &calls), product(inverse), {1e-11, 20});
  CHECK(calls == 1);
  CHECK((x - exact).norm() < 1e-9 * exact.norm());
  // As exact as asked for, and no longer than allowed: the first iteration, of length b.b / b.A b = 9.03
  // / 30.2, leaves 87 % of the residual.
  Eigen::VectorXd mostly_soft = Eigen::VectorXd::Ones(12);
  mostly_soft.tail(3).setConstant(0.1);
  const Eigen::MatrixXd diagonal = values.asDiagonal();
  x = conjugate_gradients(mostly_soft, product(diagonal), product(identity()), {0.9, 20});
  CHECK((x - 9.03 / 30.2 * mostly_soft).norm() < 1e-12);
  calls = 0;
  conjugate_gradients(b, product(a, &calls), product(identity()), {1e-11, 2});
  CHECK(calls == 2);
}

TEST_CASE("newton: where A is not positive definite, conjugate gradients stop with what they have") {
  Eigen::VectorXd values = Eigen::VectorXd::Constant(12, 2);
  const Eigen::VectorXd b = Eigen::VectorXd::Ones(12);
  // At once: the preconditioned residual.
  const Eigen::MatrixXd negative = -2 * identity(), half = 0.5 * identity();
  CHECK(conjugate_gradients(b, product(negative), product(half), {}) == 0.5 * b);
  // Later: the first iteration's step along b is b (b.b) / (b.A b) = 12 / 8 b.
  values.setConstant(1);
  values[0] = -3;
  const Eigen::MatrixXd saddle = values.asDiagonal();
  const Eigen::VectorXd x = conjugate_gradients(b, product(saddle), product(identity()), {});
  CHECK((x - 1.5 * b).norm() < 1e-12);
}

TEST_CASE("newton: the product with the Jacobian is that of a difference whose size is the nudge") {
  const Eigen::MatrixXd a = with_spectrum(Eigen::VectorXd::LinSpaced(12, 1, 9));
  const Eigen::VectorXd d = Eigen::VectorXd::Random(12), force = Eigen::VectorXd::Random(12);
  const double largest = d.cwiseAbs().maxCoeff(), offset = 1e-3;
  double step = 0;
  // r(x + s d) = r - s A d - s^2 d / 2, whose difference is A d + s d / 2.
  const auto along = [&](double s) {
    step = s;
    return Residual{force - s * (a * d) - 0.5 * s * s * d, 1, 1};
  };
  const Eigen::VectorXd found = jacobian_times(d, force, offset, along);
  CHECK(step * largest == Approx(offset));
  CHECK((found - (a * d + 0.5 * step * d)).norm() < 1e-10);
}
