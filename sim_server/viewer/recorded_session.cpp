#include "sim_server/viewer/recorded_session.h"

#include <cstring>

namespace palpate::sim {

RecordedSession::RecordedSession(const SceneFacts& scene)
    : feed_(scene.organ.rest), maker_(scene, feed_, true), link_(Time{}), picture_(feed_.pictures.front()) {
  feed_.pages = 1;
  link_.greet(false);
}

bool RecordedSession::add(Time t) {
  if (bytes_.size() + message_.capacity() + 9 * picture_.positions.size() > kLongest) return false;
  picture_.t = to_seconds(t);
  feed_.pictures.back() = picture_;
  feed_.pictures.publish();
  // A link's clock begins before all that it sends.
  const Time linked = t + PageLink::kStateEach;
  maker_.update(linked);
  if (t - complete_at_ >= kCompleteEach) {
    link_.forget_surface();
    complete_at_ = t;
  }
  while (const auto kind = link_.next(maker_.showing(), linked, message_)) put(*kind, t, message_);
  return true;
}

void RecordedSession::put(PageLink::Kind kind, Time t, const Bytes& message) {
  const auto size = static_cast<std::uint32_t>(message.size());
  const double seconds = to_seconds(t);
  const std::size_t at = bytes_.size();
  bytes_.resize(at + 16);
  std::memcpy(bytes_.data() + at, &size, sizeof size);
  bytes_[at + 4] = std::byte{kind == PageLink::Kind::kBinary ? std::uint8_t{1} : std::uint8_t{0}};
  std::memcpy(bytes_.data() + at + 8, &seconds, sizeof seconds);
  bytes_.insert(bytes_.end(), message.begin(), message.end());
}

}  // namespace palpate::sim
