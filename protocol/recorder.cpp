#include "protocol/recorder.h"

#include <algorithm>

#include "common/clock.h"
#include "common/error.h"

namespace palpate::protocol {
namespace {
constexpr Time kWritePeriod = std::chrono::milliseconds(20);
}  // namespace

Recorder::Recorder(const std::filesystem::path& file)
    : path_(file),
      file_(file, Contents::kCapture),
      capture_(file_.path()),
      ring_(kRoom),
      epoch_(monotonic_epoch()) {}

void Recorder::note(Time t, const Endpoint& from, const Endpoint& to,
                    std::span<const std::byte> bytes) noexcept {
  ++noted_;
  Packet* const packet = ring_.claim();
  if (packet == nullptr) return;
  packet->t = t;
  packet->from = from;
  packet->to = to;
  packet->length = bytes.size();
  packet->kept = std::min(bytes.size(), packet->bytes.size());
  std::copy_n(bytes.begin(), packet->kept, packet->bytes.begin());
  ring_.publish();
}

void Recorder::note_refused(Time t, const Endpoint& from, const Endpoint& to,
                            std::span<const std::byte> bytes) noexcept {
  if (refused_bucket_.take(t)) {
    note(t, from, to, bytes);
  } else {
    ++refused_;
  }
}

void Recorder::run(const std::stop_token& stop) noexcept {
  while (!stop.stop_requested()) {
    write_all();
    sleep_until(now() + kWritePeriod);
  }
  write_all();
}

void Recorder::write_all() noexcept {
  while (const Packet* const packet = ring_.front()) {
    capture_.write(epoch_ + packet->t, packet->from, packet->to, {packet->bytes.data(), packet->kept},
                   packet->length);
    if (!named_) name_it(*packet);
    ring_.release();
  }
  if (!capture_.flush()) failed.store(true, std::memory_order_relaxed);
}

void Recorder::name_it(const Packet& packet) noexcept {
  Datagram datagram;
  if (decode({packet.bytes.data(), packet.kept}, datagram) != Verdict::kAccepted ||
      datagram.header.session == 0)
    return;
  named_ = true;
  try {
    file_.commit();
  } catch (const Error&) {
    failed.store(true, std::memory_order_relaxed);
  }
}

Recorder::Stats Recorder::stats() const {
  return {capture_.packets(), capture_.bytes(), noted_ - capture_.packets(), refused_};
}

}  // namespace palpate::protocol
