#include "sim_server/deformation/moving_supports.h"

#include <algorithm>
#include <cmath>
#include <numbers>

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

/// -K_fd d for a unit displacement d along `way` of the vertices of one region, N: what the body at rest but
/// for that pulls at its free nodes.
Eigen::VectorXd load_of(const Solid& solid, const FreeDofs& dofs, const std::vector<int>& region_of,
                        int region, const Vec3& way) {
  std::vector<Vec3> x = solid.rest(), force(x.size());
  const std::size_t vertices = region_of.size();
  const auto share = [&](int vertex) { return region_of[vertex] == region ? 1.0 : 0.0; };
  for (std::size_t v = 0; v < vertices; ++v) x[v] += share(static_cast<int>(v)) * way;
  for (std::size_t k = 0; k < solid.edges().size(); ++k) {
    const auto& [a, b] = solid.edges()[k];
    if (dofs.first[vertices + k] < 0) x[vertices + k] += 0.5 * (share(a) + share(b)) * way;
  }
  solid.forces(x, force);
  Eigen::VectorXd load(dofs.count);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (dofs.first[i] >= 0) load.segment<3>(dofs.first[i]) = -force[i];
  }
  return load;
}

}  // namespace

MovingSupports::MovingSupports(const ModelInputs& inputs, const Solid& solid, const FreeDofs& dofs,
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
          factor.solve(load_of(solid, dofs, region_of, region, motion.direction)).col(0);
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
