#include "sim_server/solvers/prony_series.h"

#include <algorithm>

namespace palpate::sim {

PronySeries::PronySeries(std::span<const Relaxation> terms, std::size_t points)
    : terms_(terms.begin(), terms.end()) {
  if (terms.empty()) return;
  elastic_.assign(points, Mat3::Zero());
  memory_ = elastic_;
  stress_.assign(terms.size() * points, Mat3::Zero());
}

void PronySeries::begin(double h) {
  h_ = h;
  scale_ = 1;
  std::ranges::fill(memory_, Mat3::Zero());
  for (std::size_t k = 0; k < terms_.size(); ++k) {
    const double fraction = terms_[k].fraction;
    const auto [fade, gamma] = RelaxationStep::over(h, terms_[k].time);
    scale_ += fraction * (gamma - 1);
    for (std::size_t p = 0; p < memory_.size(); ++p)
      memory_[p] += fade * stress_[k * memory_.size() + p] - fraction * gamma * elastic_[p];
  }
}

void PronySeries::end(std::span<const Mat3> elastic) {
  for (std::size_t p = 0; p < elastic_.size(); ++p) {
    if (!elastic[p].allFinite()) continue;
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      Mat3& stress = stress_[k * elastic_.size() + p];
      const auto [fade, gamma] = RelaxationStep::over(h_, terms_[k].time);
      stress = fade * stress + terms_[k].fraction * gamma * (elastic[p] - elastic_[p]);
    }
    elastic_[p] = elastic[p];
  }
}

std::size_t PronySeries::bytes() const {
  return (elastic_.size() + memory_.size() + stress_.size()) * sizeof(Mat3);
}

}  // namespace palpate::sim
