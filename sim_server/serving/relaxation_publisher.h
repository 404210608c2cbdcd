#pragma once
#include <span>
#include <vector>

#include "protocol/messages.h"
#include "sim_server/client_model/slow_modes.h"

namespace palpate::sim {

/// Publishes the memory of a tissue that relaxes (`protocol::RelaxedState`) in parts, one with each sample:
/// the modes in turn, and in turn the vertices with a remaining force. One thread; only the constructor
/// allocates.
class RelaxationPublisher {
 public:
  /// `vertices`: of the surface, of each vertex of the model that clients have (`SurfacePager::vertices`).
  RelaxationPublisher(const PublishedModes& modes, std::span<const int> vertices);

  /// Appends the next part to a sample that has all others, as long as a datagram has room for it.
  void report(const ModalMotion& state, protocol::ForceSample& sample) noexcept;

 private:
  void publish_modes(const ModalMotion& state, std::size_t room, protocol::RelaxedState& published) noexcept;
  void publish_vertices(const ModalMotion& state, std::size_t room,
                        protocol::RelaxedState& published) noexcept;

  const PublishedModes& modes_;
  std::size_t terms_;
  std::vector<int> vertices_;
  std::size_t next_mode_ = 0, next_vertex_ = 0;
};

}  // namespace palpate::sim
