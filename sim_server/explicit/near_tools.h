#pragma once
#include <span>
#include <vector>

#include "sim_server/tissue/deformation_model.h"

namespace palpate::sim {

/// The surface vertices of a tissue that contact can come to within a step, where it looks around the tools
/// alone (`CuttableModel::restrict_contact`): the corners of each triangle of which some is in such a place,
/// or may come into one before the step ends, and what is loaded. Only the constructor allocates.
class NearTools {
 public:
  NearTools() = default;
  /// Everywhere.
  explicit NearTools(std::size_t surface_vertices) : has_(surface_vertices, 0) {
    vertices_.reserve(surface_vertices);
  }

  void search_everywhere() noexcept { narrowed_ = false; }
  /// Restricts contact to these places (none: everywhere). Surface vertices are at `positions` (m) and go by
  /// at most `path` (m) until the step ends; those of which `in_motion` is negative do not count.
  /// O(triangles).
  void search_in(std::span<const Neighbourhood> places, std::span<const Triangle> triangles,
                 std::span<const int> in_motion, std::span<const Vec3> positions, double path) noexcept;
  /// Contact looks at this vertex, too. Whether it did not before.
  bool add(int vertex) noexcept;

  bool narrowed() const noexcept { return narrowed_; }
  /// Each once.
  const std::vector<int>& vertices() const noexcept { return vertices_; }

 private:
  std::vector<char> has_;  // of surface vertices
  std::vector<int> vertices_;
  bool narrowed_ = false;
};

}  // namespace palpate::sim
