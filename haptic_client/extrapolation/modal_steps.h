#pragma once
#include <array>
#include <span>

#include "common/damped_mode.h"
#include "common/relaxation.h"

namespace palpate::client {

/// A number for each slow mode.
using ModalNumbers = std::array<double, kMaxPublishedModes>;

/// Modal state: amplitudes, their rates, and the delayed amplitudes in each term of the series by which the
/// tissue relaxes.
struct ModalState {
  ModalNumbers q{}, v{};                           // m sqrt(kg), m sqrt(kg)/s
  std::array<ModalNumbers, kMostRelaxations> z{};  // m sqrt(kg)
};

/// Equations of the modes: q_k'' + d_k q_k' + w_k^2 (q_k - sum_j fraction_j z_kj) = p_k, z_kj' = (q_k - z_kj)
/// / time_j.
struct ModalSystem {
  std::size_t count = 0, terms = 0;
  ModalNumbers w{}, damping{};  // rad/s, 1/s
  std::array<Relaxation, kMostRelaxations> series{};

  std::span<const Relaxation> relaxations() const noexcept { return std::span(series).first(terms); }
};

/// Step of all modes over one length of time, under constant forces p: exact without relaxation, second order
/// in length / time with it. No allocation.
class ModalSteps {
 public:
  /// `h`: s >= 0.
  void prepare(double h, const ModalSystem& system) noexcept;
  void advance(ModalState& state, const ModalNumbers& p) const noexcept;

 private:
  std::size_t count_ = 0;
  ModalNumbers w2_{}, q_of_q_{}, q_of_v_{}, v_of_q_{}, v_of_v_{}, q_of_p_{}, v_of_p_{};
  SeriesStep series_;
  std::array<double, kMostRelaxations> half_{};  // how much of the way z goes in half of the step
};

/// Returns the modal state after `time` (s >= 0) without any force.
ModalState free_motion(ModalState state, double time, const ModalSystem& system) noexcept;

}  // namespace palpate::client
