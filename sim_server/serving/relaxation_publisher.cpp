#include "sim_server/serving/relaxation_publisher.h"

#include <algorithm>
#include <array>

#include "protocol/codec.h"

namespace palpate::sim {
using protocol::RelaxedState;

namespace {

constexpr double kOfNote = 1e-3;  // of the largest force that is remembered
constexpr std::size_t kReal = 4;  // bytes

}  // namespace

RelaxationPublisher::RelaxationPublisher(const PublishedModes& modes, std::span<const int> vertices)
    : modes_(modes), terms_(modes.relaxations.size()), vertices_(vertices.begin(), vertices.end()) {}

void RelaxationPublisher::report(const ModalMotion& state, protocol::ForceSample& sample) noexcept {
  sample.flags |= protocol::ForceSample::kHasRelaxed;
  RelaxedState& published = sample.relaxed = {.terms = static_cast<std::uint8_t>(terms_)};
  for (std::size_t j = 0; j < terms_; ++j) {
    published.fraction[j] = static_cast<float>(modes_.relaxations[j].fraction);
    published.time[j] = static_cast<float>(modes_.relaxations[j].time);
  }
  std::array<std::byte, protocol::kMaxDatagram> bytes;
  const std::size_t empty = protocol::encode({}, sample, bytes) + protocol::kTagBytes;
  if (empty > protocol::kMaxDatagram) {
    sample.flags &= ~protocol::ForceSample::kHasRelaxed;
    return;
  }
  const std::size_t room = protocol::kMaxDatagram - empty;
  publish_modes(state, room / 2, published);
  publish_vertices(state, room - published.count * terms_ * kReal, published);
}

void RelaxationPublisher::publish_modes(const ModalMotion& state, std::size_t room,
                                        RelaxedState& published) noexcept {
  const auto modes = static_cast<std::size_t>(state.z.rows());
  if (next_mode_ >= modes) next_mode_ = 0;
  const std::size_t most = std::min(room / kReal, RelaxedState::kMostAmplitudes) / terms_,
                    count = std::min(most, modes - next_mode_);
  published.first = static_cast<std::uint8_t>(next_mode_);
  published.count = static_cast<std::uint8_t>(count);
  for (std::size_t i = 0; i < count * terms_; ++i)
    published.z[i] = static_cast<float>(
        state.z(static_cast<Eigen::Index>(next_mode_ + i / terms_), static_cast<Eigen::Index>(i % terms_)));
  next_mode_ += count;
}

/// Once around at most, on from the last one that was sent.
void RelaxationPublisher::publish_vertices(const ModalMotion& state, std::size_t room,
                                           RelaxedState& published) noexcept {
  const auto psi = [&](std::size_t number, std::size_t term) -> const Vec3& {
    return state.psi[static_cast<std::size_t>(vertices_[number]) * terms_ + term];
  };
  const auto size = [&](std::size_t number) {
    double largest = 0;
    for (std::size_t j = 0; j < terms_; ++j)
      largest = std::max(largest, psi(number, j).cwiseAbs().maxCoeff());
    return largest;
  };
  double largest = 0;
  for (std::size_t v = 0; v < vertices_.size(); ++v) largest = std::max(largest, size(v));
  const std::size_t most =
      std::min(room / (sizeof(std::uint16_t) + 3 * kReal * terms_), RelaxedState::kMostForces / terms_);
  for (std::size_t looked = 0; looked < vertices_.size() && published.vertices < most; ++looked) {
    if (next_vertex_ >= vertices_.size()) next_vertex_ = 0;
    const std::size_t v = next_vertex_++;
    if (!(size(v) > kOfNote * largest)) continue;
    RelaxedState::Vertex& vertex = published.vertex[published.vertices++];
    vertex.number = static_cast<std::uint16_t>(v);
    for (std::size_t k = 0; k < 3 * terms_; ++k)
      vertex.psi[k] = static_cast<float>(psi(v, k / 3)[static_cast<Eigen::Index>(k % 3)]);
  }
}

}  // namespace palpate::sim
