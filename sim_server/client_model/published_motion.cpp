#include "sim_server/client_model/published_motion.h"

#include <algorithm>
#include <fmt/core.h>
#include <numbers>

#include "sim_server/statics/linear_statics.h"

namespace palpate::sim {
namespace {

std::vector<int> surface_unknowns(const ModelInputs& inputs, const LinearStatics& statics) {
  std::vector<int> first;
  for (const int vertex : inputs.surface.vertices) first.push_back(statics.dofs.first[vertex]);
  return first;
}

}  // namespace

VibrationModes published_modes(const ModelInputs& inputs, const LinearStatics& statics,
                               const Eigen::VectorXd& masses) {
  const DeformationSettings& settings = inputs.scene.deformation;
  const int count = std::min(settings.of<ClientModes>().modes, statics.dofs.count - 1);
  return statics.modes(count, settings.where, masses);
}

PublishedMotion::PublishedMotion(const ModelInputs& inputs, const LinearStatics& statics,
                                 std::span<const int> places, std::span<const double> masses)
    : PublishedMotion(inputs, statics, published_modes(inputs, statics, statics.masses()), places, masses) {}

PublishedMotion::PublishedMotion(const ModelInputs& inputs, const LinearStatics& statics,
                                 const VibrationModes& found, std::span<const int> places,
                                 std::span<const double> masses)
    : modes_(found, surface_unknowns(inputs, statics), inputs.scene.deformation.of<RayleighDamping>()),
      residual_(inputs),
      shapes_(Eigen::MatrixXd::Zero(3 * static_cast<Eigen::Index>(masses.size()), modes_.published)),
      masses_(Eigen::VectorXd::Zero(shapes_.rows())),
      weighted_(shapes_.rows()) {
  for (std::size_t node = 0; node < places.size(); ++node) {
    const int first = statics.dofs.first[node];
    if (places[node] < 0 || first < 0) continue;  // the rest; what the modes do not know
    const Eigen::Index row = 3 * places[node];
    if (modes_.published > 0)
      shapes_.middleRows<3>(row) = found.shapes.middleRows<3>(first).leftCols(modes_.published);
    masses_.segment<3>(row).setConstant(masses[static_cast<std::size_t>(places[node])]);
  }
  q_ = v_ = force_ = Eigen::VectorXd::Zero(modes_.published);
  steps_.resize(static_cast<std::size_t>(modes_.published));
  modes_.relaxations = inputs.scene.material->relaxations;
  statics.fill(residual_);
  residual_.add(modes_.shapes, -modes_.published_at_rest());
}

void PublishedMotion::begin(std::span<const double> u, std::span<const double> v, std::span<const double> f,
                            double late) noexcept {
  const auto mapped = [&](std::span<const double> all) {
    return Eigen::Map<const Eigen::VectorXd>(all.data(), shapes_.rows());
  };
  amplitudes(u);
  weighted_ = masses_.cwiseProduct(mapped(v));
  v_.noalias() = shapes_.transpose() * weighted_;
  force_.noalias() = shapes_.transpose() * mapped(f);
  const auto w2 = modes_.frequencies.head(modes_.published).array().square();
  const auto damping = modes_.damping.head(modes_.published).array();
  v_.array() += late * (force_.array() - w2 * q_.array() - damping * v_.array());
}

const Eigen::VectorXd& PublishedMotion::amplitudes(std::span<const double> u) noexcept {
  weighted_ = masses_.cwiseProduct(Eigen::Map<const Eigen::VectorXd>(u.data(), shapes_.rows()));
  q_.noalias() = shapes_.transpose() * weighted_;
  return q_;
}

void PublishedMotion::advance(double time, std::span<const VertexLoad> loads, Eigen::Ref<Eigen::VectorXd> q,
                              Eigen::Ref<Eigen::VectorXd> v) noexcept {
  force_.setZero();
  modes_.add_drive(loads, force_);
  q = q_;
  v = v_;
  for (Eigen::Index k = 0; k < modes_.published; ++k) {
    ModeStep& step = steps_[static_cast<std::size_t>(k)];
    if (time != stepped_) step = ModeStep::over(time, modes_.frequencies[k], modes_.damping[k]);
    step.advance(q[k], v[k], force_[k]);
  }
  stepped_ = time;
}

void PublishedMotion::push(double time, std::span<const VertexLoad> loads, Eigen::Ref<Eigen::VectorXd> q,
                           Eigen::Ref<Eigen::VectorXd> v) noexcept {
  force_.setZero();
  modes_.add_drive(loads, force_);
  q = q_ - time * v_;
  v = v_ + time * force_;
}

void PublishedMotion::place_as(const PublishedMotion& before) noexcept {
  q_ = before.q_;
  v_ = before.v_;
}

void PublishedMotion::place_under(std::span<const VertexLoad> loads) noexcept {
  q_.setZero();
  v_.setZero();
  modes_.add_drive(loads, q_);
  q_.array() /= modes_.frequencies.head(modes_.published).array().square();
}

std::size_t PublishedMotion::bytes() const {
  return modes_.bytes() + residual_.bytes() + residual_.index_bytes() +
         static_cast<std::size_t>(shapes_.size() + 2 * masses_.size() + 3 * q_.size()) * sizeof(double) +
         steps_.size() * sizeof(ModeStep);
}

std::string PublishedMotion::detail() const {
  return fmt::format(
      "{} modes up to {:.3g} Hz, {}and the compliance of the rest: {}", modes_.published,
      modes_.published > 0 ? modes_.frequencies[modes_.published - 1] / (2 * std::numbers::pi) : 0.0,
      modes_.relaxations.empty() ? "" : "what has relaxed, ", residual_.detail());
}

}  // namespace palpate::sim
