#pragma once
#include <array>
#include <cmath>
#include <span>

#include "common/types.h"

namespace palpate {

/// A share of all stress that fades when the strain is held: one term of a Prony series.
struct Relaxation {
  double fraction;  ///< of the stress at once, (0, 1); all shares together below 1
  double time;      ///< to 1/e, s, [1e-4, 1e6]
  bool operator==(const Relaxation&) const = default;
};

/// Terms of a series that a server tells and a client steps.
constexpr int kMostRelaxations = 4;

/// Step of length h of a delayed variable r, r' = (x - r) / time, in which x changes linearly: exact (Taylor,
/// Pister and Goudreau 1970, Int. J. Numer. Meth. Engng 2:45).
struct RelaxationStep {
  double fade = 1;   ///< exp(-h / time)
  double gamma = 1;  ///< (1 - fade) time / h

  /// `h`: s >= 0.
  static RelaxationStep over(double h, double time) noexcept {
    if (!(h > 0)) return {};
    return {std::exp(-h / time), -std::expm1(-h / time) * time / h};
  }
  /// r at the end of a step in which x went from `from` to `to`.
  template <class T>
  T followed(const T& r, const T& from, const T& to) const noexcept {
    return to - fade * (from - r) - gamma * (to - from);
  }
};

/// A series over a step: of stress, and of what stress leads to.
struct SeriesStep {
  std::array<double, kMostRelaxations> fraction{};
  std::array<RelaxationStep, kMostRelaxations> step{};
  int count = 0;

  /// The first `kMostRelaxations` terms over `h` (s >= 0).
  static SeriesStep over(double h, std::span<const Relaxation> terms) noexcept {
    SeriesStep series;
    for (const Relaxation& term : terms) {
      if (series.count == kMostRelaxations) break;
      const auto j = static_cast<std::size_t>(series.count++);
      series.fraction[j] = term.fraction;
      series.step[j] = RelaxationStep::over(h, term.time);
    }
    return series;
  }

  /// A force f on a tissue that relaxes moves it as far as phi = f + sum_j fraction_j psi_j moves one that
  /// does not, psi_j' = (phi - psi_j) / time_j. Takes `psi` (N) over a step in which phi goes evenly, and f
  /// (N) from `from` to `to`.
  void creep(std::span<Vec3, kMostRelaxations> psi, const Vec3& from, const Vec3& to) const noexcept {
    const auto terms = static_cast<std::size_t>(count);
    Vec3 phi = from, end = to;
    for (std::size_t j = 0; j < terms; ++j) phi += fraction[j] * psi[j];
    double stays = 1;
    for (std::size_t j = 0; j < terms; ++j) {
      const RelaxationStep& s = step[j];
      stays -= fraction[j] * (1 - s.gamma);
      end += fraction[j] * (s.gamma * phi - s.fade * (phi - psi[j]));
    }
    end /= stays;
    for (std::size_t j = 0; j < terms; ++j) psi[j] = step[j].followed<Vec3>(psi[j], phi, end);
  }
};

}  // namespace palpate
