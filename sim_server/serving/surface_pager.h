#pragma once
#include "protocol/surface_pages.h"
#include "sim_server/simulation/simulation.h"

namespace palpate::sim {

/// The surface that one tool can touch, in pages (protocol/surface_pages.h) for clients that solve contact
/// themselves; of one that can be cut, what `Simulation::published_version` tells of it. Reads only what a
/// simulation never changes once the pager is made, so that a thread may answer requests from a pager of its
/// own while another steps. Must not outlive the simulation.
class SurfacePager {
 public:
  /// O(n log n) for n vertices. Between two steps. Allocates; nothing else here does.
  SurfacePager(const Simulation& simulation, std::size_t tool);

  /// Version 0: none, because the compliance of this tissue changes while it deforms, it is too large, or
  /// the tool is no sphere.
  /// `shift_W` is not filled in.
  const protocol::SurfaceState& state() const { return state_; }
  protocol::SurfacePages pages() const {
    return {state_.vertices, state_.triangles,
            published_ == nullptr ? 0 : static_cast<std::uint32_t>(published_->published)};
  }

  /// Which vertex of the surface each vertex of the model is.
  std::span<const int> vertices() const { return vertices_; }
  /// Returns the rest positions of its vertices, in their order, m.
  std::span<const Vec3> rest() const { return rest_; }

  /// Fills in a page of `state().version`, or says in its number that it is not known yet; false when it has
  /// none of that number. About 2 us.
  bool page(std::uint32_t number, protocol::SurfacePage& out) noexcept;

 private:
  void find_surface();
  void put_in_order();
  std::uint32_t hash() noexcept;
  bool knows_tile(std::uint32_t number) const noexcept;
  void fill_tile(std::uint32_t number, protocol::SurfacePage& out) noexcept;
  void fill_spectrum(protocol::SurfacePage& out) const noexcept;
  void fill_shapes(std::uint32_t number, protocol::SurfacePage& out) const noexcept;
  void take_compliance(std::span<const int> vertices) noexcept;
  std::span<const int> members(std::size_t cluster) const noexcept;

  const Simulation& simulation_;
  std::shared_ptr<const PublishedSurface> nearby_;  // of a surface that can be cut
  const PublishedModes* published_;                 // null: none are published
  std::uint8_t tool_;
  std::vector<int> vertices_;        // surface vertex of each vertex of the model
  std::vector<Vec3> rest_;           // of these, m
  std::vector<Triangle> triangles_;  // corners: vertices of the model
  ContactPatch patch_;               // of two clusters
  protocol::SurfaceState state_;
};

}  // namespace palpate::sim
