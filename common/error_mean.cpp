#include "common/error_mean.h"

#include <algorithm>

namespace palpate {

void ErrorMean::add(const DiscretisationError& error, double weight) noexcept {
  if (!error.known()) return;
  sum_ += weight * static_cast<double>(error.percent);
  weights_[static_cast<std::size_t>(error.source)] += weight;
}

DiscretisationError ErrorMean::mean() const noexcept {
  double all = 0;
  for (const double weight : weights_) all += weight;
  if (all == 0) return {};
  const auto most = std::ranges::max_element(weights_) - weights_.begin();
  return {static_cast<ErrorSource>(most), static_cast<float>(sum_ / all)};
}

void ErrorMeans::add(const DiscretisationErrors& errors, double newton) noexcept {
  mesh_.add(errors.mesh, newton);
  time_step_.add(errors.time_step, newton);
}

}  // namespace palpate
