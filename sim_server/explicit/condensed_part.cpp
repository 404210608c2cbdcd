#include "sim_server/explicit/condensed_part.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim_server/elasticity/tensors.h"
#include "sim_server/sparse/symmetric_product.h"

namespace palpate::sim {
namespace {

/// Returns what three columns from `first` on of a matrix with a row for each mode do with these amplitudes.
/// Without modes it has no address.
Vec3 moved_by(const Eigen::MatrixXd& modes, Eigen::Index first, const Eigen::VectorXd& amplitudes) noexcept {
  if (amplitudes.size() == 0) return Vec3::Zero();
  return modes.middleCols<3>(first).transpose() * amplitudes;
}

}  // namespace

void CondensedPart::place_at(Part& part, const std::vector<double>& u) noexcept {
  const auto& [R, shift] = part.frame;
  for (std::size_t b = 0; b < part.border.size(); ++b) {
    const auto row = 3 * static_cast<Eigen::Index>(b);
    const Eigen::Map<const Vec3> there(u.data() + part.border[b]);
    if (!part.floats) {
      part.at.segment<3>(row) = there;
      continue;
    }
    const Vec3 rest = part.border_rest.segment<3>(row);
    part.at.segment<3>(row) = R.transpose() * (rest + there - shift) - rest;
  }
}

void CondensedPart::place_at(const std::vector<double>& u) noexcept {
  for (Part& part : all_) place_at(part, u);
}

void CondensedPart::observe(const std::vector<double>& u, const std::vector<double>& v) noexcept {
  place_at(u);
  for (Part& part : all_) {
    if (part.removed) continue;
    for (std::size_t b = 0; b < part.border.size(); ++b) {
      const auto row = 3 * static_cast<Eigen::Index>(b);
      part.bent.segment<3>(row) =
          part.at.segment<3>(row) +
          damping_.stiffness * part.frame.R.transpose() * Eigen::Map<const Vec3>(v.data() + part.border[b]);
    }
    part.p_bent = part.p + damping_.stiffness * part.p_v;
    symmetric_product(part.following, part.bent, part.force);
  }
}

void CondensedPart::follow(std::span<double> force) const noexcept {
  for (const Part& part : all_) {
    for (std::size_t b = 0; !part.removed && b < part.border.size(); ++b) {
      const auto row = 3 * static_cast<Eigen::Index>(b);
      Eigen::Map<Vec3>(force.data() + part.border[b]) +=
          part.force.segment<3>(row) + moved_by(part.driven, row, part.p_bent);
    }
  }
}

void CondensedPart::advance(double h, std::span<const VertexLoad> loads) noexcept {
  for (Part& part : all_) {
    if (part.removed) continue;
    part.p_v *= 1 - h * damping_.mass;
    part.p_v.array() -= h * part.squares * part.p_bent.array();
    part.p_v.noalias() += h * (part.driven * part.bent);
  }
  for (const VertexLoad& load : loads) {
    if (!has(load.vertex)) continue;
    const auto v = static_cast<std::size_t>(load.vertex);
    Part& part = all_[static_cast<std::size_t>(part_[v])];
    if (part.p.size() > 0) part.p_v.noalias() += h * (part.shapes.middleCols<3>(row_[v]) * load.force);
  }
  for (Part& part : all_) part.p += h * part.p_v;
}

Vec3 CondensedPart::carried(int vertex) const noexcept {
  const auto v = static_cast<std::size_t>(vertex);
  const Part& part = all_[static_cast<std::size_t>(part_[v])];
  const Vec3 u =
      part.carrying.middleCols<3>(row_[v]).transpose() * part.at + moved_by(part.shapes, row_[v], part.p);
  if (!part.floats) return u;
  const Vec3 rest = part.surface_rest.segment<3>(row_[v]) - part.centre;
  return part.frame.R * (rest + u) + part.frame.shift - rest;
}

Mat3 CondensedPart::compliance(int vertex, int other) const noexcept {
  const auto v = static_cast<std::size_t>(vertex), w = static_cast<std::size_t>(other);
  if (part_[v] != part_[w]) return Mat3::Zero();
  const Part& part = all_[static_cast<std::size_t>(part_[v])];
  const auto block = part.compliance.block<3, 3>(row_[v], row_[w]);
  if (!part.floats) return block;
  return part.frame.R * block * part.frame.R.transpose();
}

void CondensedPart::watch(std::span<const int> vertices) noexcept {
  for (const int vertex : vertices) {
    if (!has(vertex)) continue;
    int& seen = seen_[static_cast<std::size_t>(vertex)];
    if (seen < step_ - 1) watched_.push_back(vertex);
    seen = step_;
  }
}

void CondensedPart::start_step() noexcept {
  ++step_;
  std::erase_if(watched_, [&](int vertex) { return seen_[static_cast<std::size_t>(vertex)] < step_ - 1; });
}

void CondensedPart::apply_loads(std::span<const VertexLoad> loads, bool all, std::span<const Vec3> free,
                                std::span<Vec3> positions) const noexcept {
  const std::span<const int> loaded_vertices = all ? vertices() : watched();
  for (const int vertex : loaded_vertices) {
    const auto v = static_cast<std::size_t>(vertex);
    positions[v] = free[v];
    for (const VertexLoad& load : loads) {
      if (has(load.vertex)) positions[v] += compliance(vertex, load.vertex) * load.force;
    }
  }
}

void CondensedPart::hand_down(const VertexLoad& load, std::span<double> force) const noexcept {
  const auto v = static_cast<std::size_t>(load.vertex);
  const Part& part = all_[static_cast<std::size_t>(part_[v])];
  const auto columns = part.carrying.middleCols<3>(row_[v]);
  const Vec3 turned = part.frame.R.transpose() * load.force;
  for (std::size_t b = 0; b < part.border.size(); ++b)
    Eigen::Map<Vec3>(force.data() + part.border[b]) +=
        part.frame.R * (columns.middleRows<3>(3 * static_cast<Eigen::Index>(b)) * turned);
}

/// Makes the answer of a part static: its modes, if any, follow at once.
void CondensedPart::take_modes_in(Part& part) {
  const Eigen::MatrixXd compliant = part.squares.inverse().matrix().asDiagonal() * part.driven,
                        shaped = part.squares.inverse().matrix().asDiagonal() * part.shapes;
  part.following.noalias() += part.driven.transpose() * compliant;
  part.carrying.noalias() += part.driven.transpose() * shaped;
  part.compliance.noalias() += part.shapes.transpose() * shaped;
  part.squares.resize(0);
  for (Eigen::MatrixXd* const modes : {&part.driven, &part.shapes}) modes->resize(0, modes->cols());
  for (Eigen::VectorXd* const amplitudes : {&part.p, &part.p_v, &part.p_bent}) amplitudes->resize(0);
}

void CondensedPart::end_modes(int part, ElasticTensors& tensors, std::vector<double>& v) {
  Part& ends = all_[static_cast<std::size_t>(part)];
  if (ends.squares.size() == 0) return;
  Eigen::MatrixXd together(ends.driven.cols(), 3);  // the border goes as one piece
  for (Eigen::Index b = 0; b < together.rows(); b += 3) together.middleRows<3>(b).setIdentity();
  const Eigen::MatrixXd amplitudes = ends.squares.inverse().matrix().asDiagonal() * (ends.driven * together);
  const double mass = amplitudes.squaredNorm() / 3;  // kg, the mean over three directions
  const Vec3 velocity = amplitudes.transpose() * ends.p_v / mass;
  const double beside = std::accumulate(ends.border_mass.begin(), ends.border_mass.end(), 0.0);
  for (std::size_t b = 0; b < ends.border.size(); ++b) {
    const double fraction = beside > 0 ? ends.border_mass[b] / beside
                                       : 1.0 / static_cast<double>(ends.border.size()),
                 kg = mass * fraction;
    const int place = ends.border[b] / 3;
    tensors.add_mass(place, kg);
    Eigen::Map<Vec3> own(v.data() + ends.border[b]);
    own += kg / tensors.masses()[static_cast<std::size_t>(place)] * (velocity - own);
  }
  take_modes_in(ends);
}

void CondensedPart::release(int part, const FloatingPieces& pieces, const Vec3& centre) {
  Part& goes = all_[static_cast<std::size_t>(part)];
  goes.floats = true;
  goes.centre = centre;
  goes.border_rest.resize(goes.at.size());
  for (std::size_t b = 0; b < goes.border.size(); ++b)
    goes.border_rest.segment<3>(3 * static_cast<Eigen::Index>(b)) = pieces.node(goes.border[b] / 3).rest;
}

void CondensedPart::turn(const FloatingPieces& pieces,
                         std::span<const FloatingPieces::Frame> frames) noexcept {
  for (Part& part : all_) {
    if (part.floats && !part.removed)
      part.frame = frames[static_cast<std::size_t>(pieces.piece_of(part.border.front() / 3))];
  }
}

CuttableModel::Removed CondensedPart::remove(int part) noexcept {
  Part& goes = all_[static_cast<std::size_t>(part)];
  if (goes.removed) return {};
  goes.removed = true;
  const double border = -0.5 * goes.at.dot(goes.following.selfadjointView<Eigen::Lower>() * goes.at);
  const double modes =
      0.5 * (goes.squares * goes.p.array().square()).sum() - goes.p.dot(goes.driven * goes.at);
  const double kinetic = 0.5 * goes.p_v.squaredNorm();
  goes.p.setZero();
  goes.p_v.setZero();
  return {.elastic = border + modes, .kinetic = kinetic};
}

std::vector<CondensedPart::BorderMass> CondensedPart::border_masses() const {
  std::vector<BorderMass> masses;
  for (const Part& part : all_) {
    for (std::size_t b = 0; b < part.border.size(); ++b)
      masses.push_back({part.border[b], part.border_mass[b]});
  }
  return masses;
}

double CondensedPart::highest_frequency() const {
  double square = 0;
  for (const Part& part : all_)
    square = std::max(square, part.squares.size() > 0 ? part.squares.maxCoeff() : 0);
  return std::sqrt(square);
}

std::size_t CondensedPart::modes() const {
  std::size_t count = 0;
  for (const Part& part : all_) count += static_cast<std::size_t>(part.squares.size());
  return count;
}

std::size_t CondensedPart::border() const {
  std::size_t count = 0;
  for (const Part& part : all_) count += part.border.size();
  return count;
}

std::size_t CondensedPart::bytes() const {
  std::size_t numbers = 0;
  for (const Part& part : all_)
    numbers += static_cast<std::size_t>(
        part.following.size() + part.carrying.size() + part.compliance.size() + part.driven.size() +
        part.shapes.size() + 3 * part.at.size() + part.surface_rest.size() + part.border_rest.size());
  return numbers * sizeof(double) + (part_of_.size() + 3 * part_.size() + 2 * vertices_.size()) * sizeof(int);
}

}  // namespace palpate::sim
