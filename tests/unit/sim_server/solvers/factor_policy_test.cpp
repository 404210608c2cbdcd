// When to factor: the table in factor_policy.h, row by row.
#include "sim_server/solvers/factor_policy.h"

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

using Decision = FactorPolicy::Decision;
using State = FactorPolicy::State;

/// Iterations of a policy, each with the relative residual that it finds of forces of 1 N.
struct Iterations {
  FactorPolicy policy;
  double previous = 0;
  Decision operator()(double relative, bool just_factored = false) {
    if (just_factored) policy.replaced();
    const Decision decision = policy.decide({{}, 1, relative}, previous, just_factored);
    previous = relative;
    return decision;
  }
};

}  // namespace

TEST_CASE("factor policy: on demand, the first slow iteration of a step with a stale factor has A factored") {
  Iterations iterate{FactorPolicy({.refresh_steps = 1})};
  CHECK_FALSE(iterate.policy.start(0));  // never exchanged
  CHECK(iterate(1, true) == Decision::kKeep);
  CHECK(iterate.policy.state() == State::kFresh);
  CHECK(iterate(0.1) == Decision::kKeep);
  CHECK(iterate.policy.state() == State::kStale);
  CHECK(iterate(0.02) == Decision::kKeep);
  CHECK(iterate(0.0061) == Decision::kRefactor);  // more than 30 %
  CHECK(iterate.policy.state() == State::kFresh);
  CHECK_FALSE(iterate.policy.uses_conjugate_gradients());
  CHECK(iterate(0.001) == Decision::kKeep);
  CHECK(iterate.policy.state() == State::kStale);
  CHECK(iterate(0.0009) == Decision::kRefactor);
  CHECK(iterate(0.0008) == Decision::kRefactorChecked);
  CHECK(iterate(0.0007) == Decision::kKeep);  // three factors a step
  CHECK(iterate.policy.uses_conjugate_gradients());
  CHECK(iterate(0.0001) == Decision::kKeep);
  CHECK(iterate.policy.uses_conjugate_gradients());  // not slow: as long as that serves
  CHECK_FALSE(iterate.policy.start(1));
  CHECK(iterate.policy.state() == State::kStale);
  iterate(1);
  CHECK(iterate(0.9) == Decision::kRefactor);  // of the next step
  iterate.policy.replaced();
  CHECK(iterate.policy.state() == State::kStale);
}

TEST_CASE("factor policy: a body that was far from balance gets every factor that it asks for") {
  for (const bool damped : {false, true}) {
    Iterations iterate{FactorPolicy({})};
    iterate.policy.start(1, damped);
    iterate(1, true);
    int factors = 0;
    for (int i = 0; i < 20; ++i) factors += iterate(0.9) == Decision::kKeep ? 0 : 1;
    CHECK(factors == (damped ? 20 : 3));
    CHECK(iterate.policy.uses_conjugate_gradients() != damped);
  }
}

TEST_CASE("factor policy: a slow iteration with a fresh factor has its digits checked") {
  Iterations iterate{FactorPolicy({})};
  iterate(1, true);
  CHECK(iterate(0.9) == Decision::kRefactorChecked);
}

TEST_CASE("factor policy: the first iteration of a step, or under other loads, is never slow") {
  Iterations iterate{FactorPolicy({})};
  iterate(1);
  iterate.policy.loads_changed();
  CHECK(iterate(5) == Decision::kKeep);
  iterate.policy.start(3);
  CHECK(iterate(5) == Decision::kKeep);
  CHECK(iterate(5) == Decision::kRefactor);
}

TEST_CASE("factor policy: of the background, a slow iteration goes on by conjugate gradients") {
  Iterations iterate{FactorPolicy({.background = true, .refresh_steps = 3})};
  CHECK(iterate.policy.start(0));
  CHECK_FALSE(iterate.policy.start(0));  // once
  iterate(1);
  CHECK_FALSE(iterate.policy.uses_conjugate_gradients());
  CHECK(iterate(0.9) == Decision::kKeep);
  CHECK(iterate.policy.uses_conjugate_gradients());
  CHECK_FALSE(iterate.policy.start(1));
  CHECK_FALSE(iterate.policy.uses_conjugate_gradients());  // tried again in each step
  CHECK_FALSE(iterate.policy.start(2));
  iterate(1);
  iterate(1);
  CHECK(iterate.policy.uses_conjugate_gradients());
  CHECK(iterate.policy.start(3));
  iterate.policy.replaced();
  CHECK_FALSE(iterate.policy.uses_conjugate_gradients());
}

TEST_CASE("factor policy: a tiny residual that a fresh factor does not lessen is rounding from then on") {
  Iterations iterate{FactorPolicy({.negligible_force = 1e-8})};
  iterate(1e-6);
  CHECK(iterate(0.9e-6) == Decision::kRefactor);  // the factor was stale
  CHECK(iterate(0.8e-6) == Decision::kStop);
  iterate.policy.start(1);
  CHECK(iterate(1.5e-6) == Decision::kStop);  // the same rounding
  CHECK(iterate(1.7e-6) == Decision::kKeep);

  // Learnt under large forces, it says nothing of small ones.
  FactorPolicy light({});
  CHECK(light.decide({{}, 1e3, 0.9e-6}, 1, true) != Decision::kStop);
  CHECK(light.decide({{}, 1e3, 0.8e-6}, 0.9e-6, false) == Decision::kStop);
  light.start(1, false);
  CHECK(light.decide({{}, 1, 1e-3}, 1, false) != Decision::kStop);

  // A tiny one that a stale factor leaves is not, whatever that factor has been through before.
  Iterations later{FactorPolicy({})};
  later(1);
  CHECK(later(0.9) == Decision::kRefactor);
  later(1e-2);
  later.policy.start(1);
  later(1e-7);
  CHECK(later(0.9e-7) == Decision::kRefactor);
  CHECK(later(0.8e-7) == Decision::kStop);

  // Next to nothing at all: 1e-3 of a negligible force, though a large share of what acts.
  FactorPolicy still({.negligible_force = 1e-8});
  CHECK(still.decide({{}, 1e-11, 1}, 0, true) == Decision::kKeep);
  CHECK(still.decide({{}, 1e-11, 0.9}, 1, false) == Decision::kStop);
  FactorPolicy moved({.negligible_force = 1e-8});
  CHECK(moved.decide({{}, 2e-11, 1}, 0, true) == Decision::kKeep);
  CHECK(moved.decide({{}, 2e-11, 0.9}, 1, false) == Decision::kRefactorChecked);
}
