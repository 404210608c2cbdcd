#include "sim_server/elasticity/turned_back.h"

#include <algorithm>

namespace palpate::sim {

Solid::TurnedBack::TurnedBack(const Solid& solid, std::span<const Vec3> x) : solid_(solid), x_(x) {
  if (solid.floating_.empty()) return;
  displacement_.assign(x.begin(), x.end());
  for (std::size_t i = 0; i < x.size(); ++i) displacement_[i] -= solid.rest_[i];
  frames_ = solid.floating_.frames(displacement_);
  turned_.assign(x.begin(), x.end());
  for (std::size_t p = 0; p < frames_.size(); ++p) {
    for (const FloatingPieces::Node& node : solid.floating_.piece(p)) {
      const auto i = static_cast<std::size_t>(node.number);
      turned_[i] = solid.rest_[i] + FloatingPieces::turned_back(node, frames_[p], displacement_[i]);
    }
  }
}

void Solid::TurnedBack::turn_forces(std::span<Vec3> f) const {
  if (frames_.empty()) return;
  solid_.floating_.turn_forces(frames_, {displacement_.front().data()}, {f.front().data()});
}

void Solid::TurnedBack::turn_blocks(int node, std::span<Mat3> blocks) const {
  const Mat3* const R = rotation(node);
  if (R == nullptr) return;
  for (Mat3& block : blocks) block = (*R * block * R->transpose()).eval();
}

void Solid::release(std::span<const std::vector<int>> parts) {
  if (material_.law != ElasticLaw::kLinear) return;
  const std::vector<double> mass = masses();
  std::vector<std::vector<FloatingPieces::Node>> pieces;
  for (const std::vector<int>& tetrahedra : parts) {
    std::vector<int> nodes;
    for (const int t : tetrahedra) {
      const std::span<const int> of_one = element(static_cast<std::size_t>(t));
      nodes.insert(nodes.end(), of_one.begin(), of_one.end());
    }
    std::ranges::sort(nodes);
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    std::vector<FloatingPieces::Node>& piece = pieces.emplace_back();
    for (const int n : nodes)
      piece.push_back({n, mass[static_cast<std::size_t>(n)], rest_[static_cast<std::size_t>(n)]});
  }
  floating_ = {std::move(pieces), rest_.size()};
}

}  // namespace palpate::sim
