#include "sim_server/client_model/published_relaxation.h"

#include <algorithm>

namespace palpate::sim {
namespace {
constexpr double kForgotten = 1e-9;  // N
}

PublishedRelaxation::PublishedRelaxation(const PublishedModes& modes) : terms_(modes.relaxations) {
  const auto vertices = static_cast<std::size_t>(modes.shapes.rows() / 3);
  for (Eigen::Index v = 0; v < modes.shapes.rows() / 3; ++v)
    held_.push_back(modes.shapes.middleRows<3>(3 * v).isZero(0));
  loads_.assign(vertices, Vec3::Zero());
  memory_ = {Eigen::VectorXd::Zero(modes.published),
             Eigen::MatrixXd::Zero(modes.published, static_cast<Eigen::Index>(terms_.size())), loads_,
             std::vector<Vec3>(vertices * terms_.size(), Vec3::Zero())};
  predicted_ = memory_;
}

void PublishedRelaxation::advance(double h, const Eigen::VectorXd& q,
                                  std::span<const VertexLoad> loads) noexcept {
  step(h, q, loads, memory_);
}

void PublishedRelaxation::predict_tangent(double h, const Eigen::VectorXd& q,
                                          std::span<const VertexLoad> loads, Eigen::MatrixXd& z,
                                          std::vector<Vec3>& psi) noexcept {
  predicted_ = memory_;
  step(h, q, loads, predicted_);
  z = predicted_.z;
  psi = predicted_.psi;
}

void PublishedRelaxation::step(double h, const Eigen::VectorXd& q, std::span<const VertexLoad> loads,
                               Memory& memory) noexcept {
  const SeriesStep series = SeriesStep::over(h, terms_);
  for (std::size_t j = 0; j < terms_.size(); ++j) {
    auto z = memory.z.col(static_cast<Eigen::Index>(j));
    for (Eigen::Index k = 0; k < z.size(); ++k) z[k] = series.step[j].followed(z[k], memory.q[k], q[k]);
  }
  memory.q = q;
  std::ranges::fill(loads_, Vec3::Zero());
  for (const VertexLoad& load : loads) {
    if (held_[static_cast<std::size_t>(load.vertex)] == 0)
      loads_[static_cast<std::size_t>(load.vertex)] += load.force;
  }
  std::array<Vec3, kMostRelaxations> psi;
  for (std::size_t v = 0; v < loads_.size(); ++v) {
    const std::span<Vec3> of_vertex = std::span(memory.psi).subspan(v * terms_.size(), terms_.size());
    const auto rests = [](const Vec3& force) { return force.cwiseAbs().maxCoeff() < kForgotten; };
    const bool forgotten = rests(memory.f[v]) && rests(loads_[v]) && std::ranges::all_of(of_vertex, rests);
    std::ranges::copy(of_vertex, psi.begin());
    if (forgotten) {
      psi.fill(Vec3::Zero());
    } else {
      series.creep(psi, memory.f[v], loads_[v]);
    }
    std::copy_n(psi.begin(), of_vertex.size(), of_vertex.begin());
    memory.f[v] = loads_[v];
  }
}

std::size_t PublishedRelaxation::bytes() const {
  return 2 * (static_cast<std::size_t>(memory_.q.size() + memory_.z.size()) * sizeof(double) +
              (memory_.f.size() + memory_.psi.size()) * sizeof(Vec3)) +
         loads_.size() * sizeof(Vec3) + held_.size();
}

}  // namespace palpate::sim
