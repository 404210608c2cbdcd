#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "common/types.h"

namespace palpate::sim {

/// Pieces of linear tissue that nothing holds, each in a floating frame. The linear law takes a turn for
/// strain, so that a piece that turns would swell. So each piece has one rotation R, the one that takes its
/// nodes nearest from rest to where they are, by mass (Kabsch 1976, Acta Cryst. A32:922, by polar
/// decomposition). With X a node at rest and x where it is, both from the centre of mass, the linear forces
/// are those of the displacement turned back, u' = R^T x - X, and act turned:
///   f = R (K u') - m a x R X,   a such that the moment sum x x f is 0.
/// The second term is how R follows x: these forces are the gradient of u'^T K u' / 2. They have neither sum
/// nor moment, so that momentum and angular momentum are kept. A value; any thread may call what is const.
class FloatingPieces {
 public:
  /// A node of a piece.
  struct Node {
    int number;   ///< of the caller
    double mass;  ///< kg, > 0
    Vec3 rest;    ///< m, from anywhere; kept from the centre of mass of the piece
  };
  /// Rotation of a piece, and the displacement of its centre of mass, m.
  struct Frame {
    Mat3 R;
    Vec3 shift;
  };
  /// Three numbers of each node, those of node i from `first + stride i` on.
  template <class Number>
  struct Vectors {
    Number* first;
    std::ptrdiff_t stride = 3;
  };

  FloatingPieces() = default;
  /// `nodes`: how many numbers of nodes there are. Pieces share none. O(nodes).
  FloatingPieces(std::vector<std::vector<Node>> pieces, std::size_t nodes);

  bool empty() const { return pieces_.empty(); }
  std::size_t count() const { return pieces_.size(); }
  /// Returns the piece of a node, or -1: it is of none.
  int piece_of(int number) const {
    const auto n = static_cast<std::size_t>(number);
    return n < places_.size() ? places_[n].piece : -1;
  }
  /// Returns a node of a piece.
  const Node& node(int number) const {
    const auto& [piece, index] = places_[static_cast<std::size_t>(number)];
    return pieces_[static_cast<std::size_t>(piece)][index];
  }
  std::span<const Node> piece(std::size_t p) const { return pieces_[p]; }

  /// Finds the frame of each piece at the displacements `u` (m). O(nodes of pieces). Does not allocate.
  void find_frames(Vectors<const double> u, std::span<Frame> frames) const noexcept;
  std::vector<Frame> frames(std::span<const Vec3> u) const;
  /// Returns u' of a node that is displaced by `u`, m.
  static Vec3 turned_back(const Node& node, const Frame& frame, const Vec3& u) {
    return frame.R.transpose() * (node.rest + u - frame.shift) - node.rest;
  }
  /// Turns the forces K u' (N) on the nodes of pieces into f. O(nodes of pieces). Does not allocate.
  void turn_forces(std::span<const Frame> frames, Vectors<const double> u, Vectors<double> f) const noexcept;

  std::size_t bytes() const;

 private:
  struct Place {
    int piece = -1;
    std::size_t index = 0;  // in it
  };
  std::vector<std::vector<Node>> pieces_;
  std::vector<Place> places_;  // of nodes
};

}  // namespace palpate::sim
