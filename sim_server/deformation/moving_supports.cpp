#include "sim_server/deformation/moving_supports.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim_server/elasticity/element.h"

namespace palpate::sim {
namespace {

/// Which vertices each [[fixed]] moves, given to the first that holds them: -1 for a free one.
std::vector<int> region_of_vertices(const Scene& scene, const TetMesh& mesh) {
  std::vector<int> region(mesh.vertices.size(), -1);
  for (std::size_t r = scene.fixed.size(); r-- > 0;) {
    for (const int vertex : vertices_in(scene.fixed[r], mesh)) region[vertex] = static_cast<int>(r);
  }
  return region;
}

/// -K_fd d for the displacement `way` of the vertices of one region, N.
Eigen::VectorXd load_of(const ModelInputs& inputs, const FreeDofs& dofs, const std::vector<int>& region_of,
                        int region, const Vec3& way) {
  Eigen::VectorXd load = Eigen::VectorXd::Zero(dofs.count);
  const auto& x = inputs.mesh.vertices;
  for (const Tetrahedron& t : inputs.mesh.tetrahedra) {
    if (std::none_of(t.begin(), t.end(), [&](int v) { return region_of[v] == region; })) continue;
    const LinearTetrahedron element({x[t[0]], x[t[1]], x[t[2]], x[t[3]]});
    for (int i = 0; i < 4; ++i) {
      if (dofs.first[t[i]] < 0) continue;
      for (int j = 0; j < 4; ++j) {
        if (region_of[t[j]] != region) continue;
        load.segment<3>(dofs.first[t[i]]) -= element.stiffness_block(i, j, *inputs.scene.material) * way;
      }
    }
  }
  return load;
}

}  // namespace

MovingSupports::MovingSupports(const ModelInputs& inputs, const FreeDofs& dofs,
                               const SparseCholesky& factor) {
  const auto region_of = region_of_vertices(inputs.scene, inputs.mesh);
  for (const int vertex : inputs.surface.vertices) rest_.push_back(inputs.mesh.vertices[vertex]);
  positions_ = rest_;
  velocities_.resize(rest_.size(), Vec3::Zero());
  for (std::size_t r = 0; r < inputs.scene.fixed.size(); ++r) {
    for (const SupportMotion& motion : inputs.scene.fixed[r].motions) {
      inputs.progress("computing moving supports", 0);
      const auto region = static_cast<int>(r);
      const Eigen::VectorXd u =
          factor.solve(load_of(inputs, dofs, region_of, region, motion.direction)).col(0);
      Column column{motion, {}};
      for (const int vertex : inputs.surface.vertices) {
        const int first = dofs.first[vertex];
        column.moved.push_back(first >= 0                    ? Vec3(u.segment<3>(first))
                               : region_of[vertex] == region ? motion.direction
                                                             : Vec3(Vec3::Zero()));
      }
      columns_.push_back(std::move(column));
    }
  }
}

FreeMotion MovingSupports::advance(double dt) noexcept {
  time_ += dt;
  std::copy(rest_.begin(), rest_.end(), positions_.begin());
  std::fill(velocities_.begin(), velocities_.end(), Vec3::Zero());
  for (const Column& column : columns_) {
    const auto& [direction, amplitude, period, phase] = column.motion;
    const double omega = 2 * std::numbers::pi / period, angle = omega * time_ + phase;
    const double way = amplitude * std::sin(angle), speed = amplitude * omega * std::cos(angle);
    for (std::size_t v = 0; v < rest_.size(); ++v) {
      positions_[v] += way * column.moved[v];
      velocities_[v] += speed * column.moved[v];
    }
  }
  return {positions_, velocities_};
}

std::size_t MovingSupports::bytes() const {
  return (columns_.size() + 3) * rest_.size() * sizeof(Vec3);
}

}  // namespace palpate::sim
