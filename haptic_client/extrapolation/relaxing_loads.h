#pragma once
#include <array>
#include <span>
#include <vector>

#include "common/contact/vertex_load.h"
#include "common/relaxation.h"
#include "haptic_client/extrapolation/surface_model.h"
#include "haptic_client/extrapolation/tick_memory.h"
#include "protocol/messages.h"

namespace palpate::client {

/// Viscous memory of the surface compliance of a tissue that relaxes (`SeriesStep::creep`). For each vertex
/// loaded lately, the client steps the memory under the loads of its contact. Each sample that covers the
/// vertex corrects it: the sampled memory is advanced to now under the loads rendered since. When there are
/// too many vertices, the unloaded one with the smallest memory is dropped. Haptic thread; only the
/// constructor allocates, 0.6 MB.
class RelaxingLoads {
 public:
  static constexpr std::size_t kMost = 32;  ///< vertices
  using Terms = std::array<Relaxation, kMostRelaxations>;

  RelaxingLoads();

  /// Nothing is remembered at `t`, of a tissue with this series; none: it does not relax.
  void begin(Time t, std::span<const Relaxation> series) noexcept;
  /// Goes on to `t` under the loads of the last `apply_loads`.
  void advance(Time t) noexcept;
  /// The surface bears these loads from the time of `advance` on, times `fraction`.
  void apply_loads(const SurfaceModel& model, std::span<const VertexLoad> loads, double fraction) noexcept;
  /// Takes the memory of some vertices at `t` as the server published it.
  void take(const SurfaceModel& model, const protocol::RelaxedState& published, Time t) noexcept;

  /// The loads that would hold the surface where it has crept to, N.
  std::span<const VertexLoad> creeping() const noexcept { return creeping_; }
  /// Returns that creep of a vertex, m; vertices that the model does not know count as 0.
  Vec3 creep(const SurfaceModel& model, int vertex) const noexcept;

 private:
  using Forces = std::array<Vec3, kMostRelaxations>;
  struct Vertex {
    int number = 0;
    bool held = false;  // by the wall, which does not creep
    Vec3 load = Vec3::Zero();
    Forces psi{};
  };
  /// The loads at a tick, as many as are remembered of one.
  struct Loads {
    std::size_t count = 0;
    std::array<int, kMost> vertex;
    std::array<Eigen::Vector3f, kMost> force;
    Vec3 on(int number) const noexcept;
  };
  Vertex* find(int number) noexcept;
  Vertex* find_or_add(const SurfaceModel& model, int number) noexcept;
  void replay(std::span<Vertex* const> vertices, Time t) noexcept;
  void note_creeping() noexcept;
  SeriesStep over(Time time) const noexcept {
    return SeriesStep::over(to_seconds(time), std::span(series_).first(terms_));
  }

  Terms series_{};
  std::size_t terms_ = 0;
  Time time_{}, noted_{};
  std::vector<Vertex> vertices_;      // at most `kMost`
  std::vector<VertexLoad> creeping_;  // of these
  TickMemory<Loads> past_;
};

}  // namespace palpate::client
