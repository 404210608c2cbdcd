#include "sim_server/client_model/slow_modes.h"

#include <algorithm>
#include <fmt/core.h>

#include "common/damped_mode.h"
#include "common/error.h"

namespace palpate::sim {

ClientModes ClientModes::read(const Config& config) {
  ClientModes read;
  read.modes = static_cast<int>(config.integer("client_modes", {0, kMaxPublishedModes, "modes"}, read.modes));
  return read;
}

std::string ClientModes::to_text() const {
  return fmt::format("client_modes = {}\n", modes);
}

PublishedModes::PublishedModes(const VibrationModes& modes, std::span<const int> first,
                               const RayleighDamping& rayleigh)
    : frequencies(modes.frequencies),
      damping(rayleigh.mass + rayleigh.stiffness * frequencies.array().square()),
      shapes(Eigen::MatrixXd::Zero(3 * static_cast<Eigen::Index>(first.size()), frequencies.size())) {
  const Eigen::Index most = std::min<Eigen::Index>(kMaxPublishedModes, frequencies.size());
  while (published < most && frequencies[published] <= kFastestPublishedMode &&
         damping[published] <= kMaxPublishedDamping)
    ++published;
  for (std::size_t v = 0; v < first.size(); ++v) {
    if (first[v] >= 0)
      shapes.middleRows<3>(3 * static_cast<Eigen::Index>(v)) = modes.shapes.middleRows<3>(first[v]);
  }
}

void PublishedModes::take_out(std::span<const int> vertices, const Eigen::VectorXd& yields,
                              ContactPatch& patch) const noexcept {
  const auto at = [&](std::size_t i, Eigen::Index k) { return shapes.col(k).segment<3>(3 * vertices[i]); };
  for (std::size_t j = 0; j < vertices.size(); ++j) {
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      Mat3 taken = Mat3::Zero();
      for (Eigen::Index k = 0; k < yields.size(); ++k) taken += yields[k] * at(i, k) * at(j, k).transpose();
      patch.compliance.block<3, 3>(3 * static_cast<Eigen::Index>(i), 3 * static_cast<Eigen::Index>(j)) -=
          taken;
    }
  }
}

void PublishedModes::add_drive(std::span<const VertexLoad> loads,
                               Eigen::Ref<Eigen::VectorXd> drive) const noexcept {
  for (const VertexLoad& load : loads)
    drive.noalias() +=
        shapes.middleRows<3>(3 * static_cast<Eigen::Index>(load.vertex)).leftCols(published).transpose() *
        load.force;
}

Eigen::VectorXd PublishedModes::published_at_rest() const {
  Eigen::VectorXd yields = Eigen::VectorXd::Zero(frequencies.size());
  yields.head(published) = frequencies.head(published).array().square().inverse();
  return yields;
}

Mat3 PublishedModes::yield_(std::span<const VertexLoad> loads, double seconds, double before,
                            Eigen::Index end) const noexcept {
  const Vec3 sum = sum_of(loads);
  Mat3 yields = Mat3::Zero();
  for (Eigen::Index k = 0; k < end; ++k) {
    Vec3 moves = Vec3::Zero();
    for (const VertexLoad& load : loads)
      moves += fraction_of(load, sum) * shapes.col(k).segment<3>(3 * load.vertex);
    const double more = ModeStep::over(seconds, frequencies[k], damping[k]).q_of_p -
                        ModeStep::over(before, frequencies[k], damping[k]).q_of_p;
    yields += more * moves * moves.transpose();
  }
  return yields;
}

}  // namespace palpate::sim
