#pragma once
#include "sim_server/elasticity/solid.h"

namespace palpate::sim {

/// A body at positions `x` (nodes, m), its floating pieces turned back by their frames. Without any, no more
/// than `x`. Allocates where there are some.
class Solid::TurnedBack {
 public:
  TurnedBack(const Solid& solid, std::span<const Vec3> x);
  std::span<const Vec3> x() const { return turned_.empty() ? x_ : turned_; }
  /// Returns the rotation of a node; null: it has none.
  const Mat3* rotation(int node) const {
    const int piece = solid_.floating_.piece_of(node);
    return piece < 0 ? nullptr : &frames_[static_cast<std::size_t>(piece)].R;
  }
  /// Turns forces (nodes, N) at `x()` into those of the body.
  void turn_forces(std::span<Vec3> f) const;
  /// Turns blocks of the stiffness of an element that has this node.
  void turn_blocks(int node, std::span<Mat3> blocks) const;

 private:
  const Solid& solid_;
  std::span<const Vec3> x_;
  std::vector<Vec3> displacement_, turned_;  // m
  std::vector<FloatingPieces::Frame> frames_;
};

}  // namespace palpate::sim
