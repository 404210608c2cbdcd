#pragma once
#include "sim_server/solvers/newton.h"

namespace palpate::sim {

/// Decides when the matrix A of Newton's method is factored, how a search direction is found with the factor
/// that there is, and when what is left of a residual is rounding. It counts and compares; it factors
/// nothing.
///
/// An iteration is slow where it leaves more than 30 % of the residual that the one before found under the
/// same loads. What the factor is to the iteration that asks, and what a slow iteration leads to:
///
/// | state     | the factor is                           | on demand                | in the background |
/// |-----------|-----------------------------------------|--------------------------|-------------------|
/// | kStale    | of elsewhere                            | kRefactor, kFresh        | kKeep, kOutdated  |
/// | kFresh    | made for the iteration before           | kRefactorChecked, kFresh | kKeep, kOutdated  |
/// | kOutdated | one that a slow iteration has been with | kKeep, kOutdated         | kKeep, kOutdated  |
///
/// On demand a step makes three factors at most; after that a slow iteration makes kOutdated of the last.
/// With a factor that is kOutdated, search directions are found by conjugate gradients which it
/// preconditions. A body that was far from balance (`damped`) gets all factors that it asks for. An iteration
/// that is not slow leaves kOutdated as it is, and makes kFresh of a factor made for it and kStale of any
/// other. A new factor (`replaced`) begins as kStale, and a kOutdated one is kStale again when the next step
/// begins.
///
/// Rounding: where a slow iteration had a factor that is kFresh or kOutdated and the residual is tiny, no
/// factor lessens it. The iteration ends there (`kStop`), and so does from then on each that finds no more
/// than twice that force.
class FactorPolicy {
 public:
  enum class State { kFresh, kStale, kOutdated };
  enum class Decision {
    kStop,             ///< the residual is rounding
    kKeep,             ///< go on with the factor that there is
    kRefactor,         ///< factor A here first
    kRefactorChecked,  ///< the same, and see whether the last factor was in want of digits
  };
  struct Settings {
    bool background = false;      ///< factors come from the background, none is made on demand
    int refresh_steps = 8;        ///< between two factors of the background, >= 1
    double negligible_force = 0;  ///< N: of a residual of 1e-3 of it nothing is expected
  };
  explicit FactorPolicy(const Settings& settings) : settings_(settings) {}

  /// A step begins, after so many others: whether it takes the factor that the background has made, and has
  /// the next one begun. Once for each number of steps. `damped`: one before ended far from balance;
  /// `unbalanced`: the one before was not solved, which is no fault of the loads.
  bool start(int steps_before, bool damped = false, bool unbalanced = false);
  /// The next residual is of other loads: that it is no smaller says nothing of the factor.
  void loads_changed() { comparable_ = false; }
  /// There is another factor, for another reason than a `Decision`.
  void replaced() { state_ = State::kStale; }
  /// Decides for an iteration that finds `residual`, where the one before it found the relative residual
  /// `previous`. `just_factored`: A has been factored for it, after `replaced`.
  Decision decide(const Residual& residual, double previous, bool just_factored);

  State state() const { return state_; }
  /// True if the search direction is found by conjugate gradients that the factor preconditions.
  bool uses_conjugate_gradients() const { return state_ == State::kOutdated; }

 private:
  bool is_rounding(const Residual& residual, double times = 1) const;

  Settings settings_;
  State state_ = State::kStale;
  bool damped_ = false;
  int demanded_ = 0;         // factors, in this step
  bool comparable_ = false;  // an iteration has been before, under the same loads
  double rounding_ = 0;      // residual that no factor lessens, N; 0: not known
  int exchanged_ = -1;       // steps before the last exchange
};

}  // namespace palpate::sim
