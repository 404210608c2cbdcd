#pragma once
#include <span>
#include <vector>

#include "sim_server/deformation/deformation_model.h"
#include "sim_server/deformation/model_inputs.h"

namespace palpate::sim {

/// The surface vertices of a tissue that contact can come to within a step, where it looks around the tools
/// alone (`DeformationModel::narrow`): the corners of all that lies in such a place, what may come into one
/// before the step ends, and what is loaded. Only the constructor allocates, and `copy`.
class NearTools {
 public:
  /// Everywhere. O(tetrahedra).
  explicit NearTools(const ModelInputs& inputs);

  /// Of a vertex that became two.
  void copy(int vertex, int copy) {
    reach_[static_cast<std::size_t>(copy)] = reach_[static_cast<std::size_t>(vertex)];
  }
  void look_everywhere() noexcept { narrowed_ = false; }
  /// In these places alone (none: everywhere), of the vertices `all`, which are at `positions` (m) and go by
  /// at most `way` (m) until the step ends.
  void look_in(std::span<const Neighbourhood> places, std::span<const int> all,
               std::span<const Vec3> positions, double way) noexcept;
  /// Contact looks at this vertex, too. Whether it did not before.
  bool add(int vertex) noexcept;

  bool narrowed() const noexcept { return narrowed_; }
  /// Each once.
  const std::vector<int>& vertices() const noexcept { return vertices_; }

 private:
  std::vector<double>
      reach_;              // of surface vertices: how far a point of a triangle may be from that corner, m
  std::vector<char> has_;  // of surface vertices
  std::vector<int> vertices_;
  bool narrowed_ = false;
};

}  // namespace palpate::sim
