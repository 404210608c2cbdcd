#include "sim_server/elasticity/floating_pieces.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <type_traits>
#include <utility>

#include "sim_server/elasticity/rotations.h"

namespace palpate::sim {
namespace {

constexpr double kFlat = 1e-12;  // least determinant of a moment of inertia, of its size to the third

template <class Number>
auto vector_of(const FloatingPieces::Vectors<Number>& all, int node) {
  using Vector = std::conditional_t<std::is_const_v<Number>, const Vec3, Vec3>;
  return Eigen::Map<Vector>(all.first + all.stride * node);
}

Vec3 mean_of(std::span<const FloatingPieces::Node> piece, const auto& value) {
  Vec3 sum = Vec3::Zero();
  double mass = 0;
  for (const FloatingPieces::Node& node : piece) {
    sum += node.mass * value(node);
    mass += node.mass;
  }
  return sum / mass;
}

}  // namespace

FloatingPieces::FloatingPieces(std::vector<std::vector<Node>> pieces, std::size_t nodes)
    : pieces_(std::move(pieces)), places_(nodes) {
  for (std::size_t p = 0; p < pieces_.size(); ++p) {
    const Vec3 centre = mean_of(pieces_[p], [](const Node& node) { return node.rest; });
    for (std::size_t i = 0; i < pieces_[p].size(); ++i) {
      Node& node = pieces_[p][i];
      node.rest -= centre;
      places_[static_cast<std::size_t>(node.number)] = {static_cast<int>(p), i};
    }
  }
}

void FloatingPieces::find_frames(Vectors<const double> u, std::span<Frame> frames) const noexcept {
  for (std::size_t p = 0; p < pieces_.size(); ++p) {
    const Vec3 shift = mean_of(pieces_[p], [&](const Node& node) { return vector_of(u, node.number); });
    Mat3 covariance = Mat3::Zero();
    for (const Node& node : pieces_[p])
      covariance += node.mass * (node.rest + vector_of(u, node.number) - shift) * node.rest.transpose();
    frames[p] = {nearest_rotation(covariance), shift};
  }
}

std::vector<FloatingPieces::Frame> FloatingPieces::frames(std::span<const Vec3> u) const {
  std::vector<Frame> found(pieces_.size());
  if (!found.empty()) find_frames({u.front().data()}, found);
  return found;
}

void FloatingPieces::turn_forces(std::span<const Frame> frames, Vectors<const double> u,
                                 Vectors<double> f) const noexcept {
  for (std::size_t p = 0; p < pieces_.size(); ++p) {
    const auto& [R, shift] = frames[p];
    Vec3 moment = Vec3::Zero();
    Mat3 spread = Mat3::Zero();  // sum m (R X) x^T
    for (const Node& node : pieces_[p]) {
      auto force = vector_of(f, node.number);
      force = (R * force).eval();
      const Vec3 x = node.rest + vector_of(u, node.number) - shift;
      moment += x.cross(force);
      spread += node.mass * (R * node.rest) * x.transpose();
    }
    // The moment of m a x R X: (tr(spread) I - spread) a.
    const Mat3 inertia = spread.trace() * Mat3::Identity() - spread;
    const double size = std::abs(spread.trace());
    if (!(std::abs(inertia.determinant()) > kFlat * size * size * size)) continue;  // crushed to a line
    const Vec3 a = inertia.inverse() * moment;
    for (const Node& node : pieces_[p]) vector_of(f, node.number) -= node.mass * a.cross(R * node.rest);
  }
}

std::size_t FloatingPieces::bytes() const {
  std::size_t bytes = places_.size() * sizeof(Place);
  for (const std::vector<Node>& piece : pieces_) bytes += piece.size() * sizeof(Node);
  return bytes;
}

}  // namespace palpate::sim
