#include "protocol/recorder.h"

#include <algorithm>
#include <fmt/format.h>

#include "common/clock.h"
#include "common/error.h"
#include "common/overwrite.h"

namespace palpate::protocol {
namespace {
constexpr Time kWritePeriod = std::chrono::milliseconds(20);  // the ring fills at 400 000 datagrams a second
}  // namespace

Recorder::Recorder(const std::filesystem::path& file, std::optional<std::uint64_t> most_bytes, bool overwrite)
    : path_(file),
      most_bytes_(most_bytes),
      overwrite_(overwrite),
      part_(std::in_place, file),
      ring_(kRoom),
      epoch_(monotonic_epoch()) {}

std::filesystem::path Recorder::path_of(const std::filesystem::path& file, std::uint64_t number) {
  if (number == 1) return file;
  std::filesystem::path next = file;
  return next.replace_filename(
      fmt::format("{}-{}{}", file.stem().string(), number, file.extension().string()));
}

void Recorder::start_next() noexcept {
  ended_ = written();
  part_.reset();
  try {
    part_.emplace(path_of(path_, ended_.files + 1));
    std::error_code expired;
    if (ended_.files >= kStoredFiles)
      std::filesystem::remove(path_of(path_, ended_.files + 1 - kStoredFiles), expired);
  } catch (const std::exception&) {
    failed.store(true, std::memory_order_relaxed);
  }
}

void Recorder::note(Time t, const Endpoint& from, const Endpoint& to,
                    std::span<const std::byte> bytes) noexcept {
  ++noted_;
  Packet* const packet = ring_.claim();
  if (packet == nullptr) return;
  packet->t = t;
  packet->from = from;
  packet->to = to;
  packet->length = bytes.size();
  packet->stored = std::min(bytes.size(), packet->bytes.size());
  std::copy_n(bytes.begin(), packet->stored, packet->bytes.begin());
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
    if (part_) {
      part_->capture.write(epoch_ + packet->t, packet->from, packet->to,
                           {packet->bytes.data(), packet->stored}, packet->length);
      if (!part_->named) name_it(*packet);
      if (most_bytes_ && part_->named && part_->capture.bytes() >= *most_bytes_) start_next();
    }
    ring_.release();
  }
  if (!part_ || !part_->capture.flush()) failed.store(true, std::memory_order_relaxed);
}

void Recorder::name_it(const Packet& packet) noexcept {
  Datagram datagram;
  if (decode({packet.bytes.data(), packet.stored}, datagram) != Verdict::kAccepted ||
      datagram.header.session == 0)
    return;
  part_->named = true;
  try {
    set_aside({{"--record", path_of(path_, ended_.files + 1)}}, overwrite_);
    part_->file.commit();
  } catch (const std::exception&) {
    failed.store(true, std::memory_order_relaxed);
  }
}

Recorder::Stats Recorder::written() const {
  Stats all = ended_;
  if (part_) {
    ++all.files;
    all.packets += part_->capture.packets();
    all.bytes += part_->capture.bytes();
  }
  return all;
}

Recorder::Stats Recorder::stats() const {
  Stats all = written();
  all.dropped = noted_ - all.packets;
  all.refused = refused_;
  return all;
}

}  // namespace palpate::protocol
