#include "tests/emulation/ft232r.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <string_view>

namespace palpate::emulation {
namespace {

constexpr std::size_t kPacket = 64, kPayload = 62;  // bytes
constexpr double kFrame = 1e-3, kJoinWait = 3e-3;   // s
constexpr std::size_t kSplitAt = 14, kReply = 16;   // bytes, of the faults `split` and `join`
constexpr std::size_t kEepromWords = 64;            // of 16 bits
constexpr std::uint8_t kStatusAlways = 0x01, kCts = 0x10, kSenderEmpty = 0x60;

/// A string descriptor at byte `at`, and where and how long it is at `entry`; the place behind it.
std::size_t put_text(Bytes& bytes, std::size_t entry, std::size_t at, std::string_view text) {
  constexpr std::uint8_t kString = 3, kMapped = 0x80;
  const std::size_t size = 2 + 2 * text.size();
  bytes[entry] = static_cast<std::uint8_t>(kMapped | at);
  bytes[entry + 1] = bytes[at] = static_cast<std::uint8_t>(size);
  bytes[at + 1] = kString;
  for (std::size_t i = 0; i < text.size(); ++i) bytes[at + 2 + 2 * i] = static_cast<std::uint8_t>(text[i]);
  return at + size;
}

}  // namespace

double baud_of_divisor(std::uint16_t divisor) {
  constexpr std::array<double, 4> kFraction{0, 0.5, 0.25, 0.125};
  if (divisor == 0) return 3e6;
  if (divisor == 1) return 2e6;
  return 3e6 / ((divisor & 0x3fff) + kFraction[divisor >> 14]);
}

/// The layout and the checksum are those that libftdi reads and writes (ftdi_eeprom_build): ids, power and
/// strings by place, and at the end a word over all others.
Bytes eeprom_of_falcon() {
  Bytes bytes(2 * kEepromWords, 0);
  const Bytes head{0x00, 0x00, 0x03, 0x04, 0x48, 0xcb, 0x00, 0x06, 0xa0, 45, 0x08, 0x00, 0x00, 0x02};
  std::ranges::copy(head, bytes.begin());
  const std::size_t product = put_text(bytes, 0x0e, 0x18, "FTDI"),
                    serial = put_text(bytes, 0x10, product, "FALCON HAPTIC");
  put_text(bytes, 0x12, serial, "");
  unsigned checksum = 0xaaaa;
  for (std::size_t i = 0; i + 1 < kEepromWords; ++i) {
    checksum ^= static_cast<unsigned>(bytes[2 * i]) | static_cast<unsigned>(bytes[2 * i + 1]) << 8;
    checksum = (checksum << 1 | checksum >> 15) & 0xffff;
  }
  bytes[bytes.size() - 2] = static_cast<std::uint8_t>(checksum & 0xff);
  bytes[bytes.size() - 1] = static_cast<std::uint8_t>(checksum >> 8);
  return bytes;
}

void Ft232r::power_up() {
  fifo_.clear();
  baud_ = 9600;
  latency_ = 0.016;
}

UsbResult Ft232r::request(const UsbSetup& setup, double) {
  constexpr std::uint8_t kIn = 0xc0, kOut = 0x40, kModemStatus = 5, kGetLatency = 10, kReadEeprom = 0x90;
  if (faults_.stall > 0) {
    --faults_.stall;
    return {-EPIPE, {}};
  }
  if (setup.type == kIn && setup.request == kGetLatency)
    return {0, {static_cast<std::uint8_t>(std::lround(latency_ * 1e3))}};
  if (setup.type == kIn && setup.request == kModemStatus) {
    Bytes status;
    append_status(status);
    return {0, status};
  }
  if (setup.type == kIn && setup.request == kReadEeprom) {  // `index`: which word
    if (setup.index >= kEepromWords) return {-EPIPE, {}};
    const auto first = eeprom_.begin() + 2 * setup.index;
    return {0, {first, first + 2}};
  }
  if (setup.type != kOut || !set(setup)) return {-EPIPE, {}};
  return {};
}

bool Ft232r::set(const UsbSetup& setup) {
  constexpr std::uint8_t kReset = 0, kModem = 1, kFlow = 2, kBaud = 3, kFormat = 4, kEvent = 6, kError = 7,
                         kLatency = 9;
  const int low = setup.value & 0xff, high = setup.value >> 8;
  switch (setup.request) {
    case kReset:  // 0 resets; of 1 and 2 nobody agrees which is which, so a host must send both
      if (low > 2) return false;
      if (low != 2) fifo_.clear();
      return true;
    case kModem:
      if (high & 1) line_.set_dtr(low & 1);
      return true;
    case kBaud:
      baud_ = baud_of_divisor(setup.value);
      line_.set_baud(baud_);
      return true;
    case kLatency:
      if (low < 1) return false;
      latency_ = low * 1e-3;
      return true;
    default:
      return setup.request == kFlow || setup.request == kFormat || setup.request == kEvent ||
             setup.request == kError;
  }
}

void Ft232r::write(const Bytes& data, double now) {
  double received = now;
  if (wall_)
    received = line_free_ = std::max(line_free_, now) + 10 * static_cast<double>(data.size()) / baud_;
  for (const Bytes& message : line_.receive(data, baud_)) answer(message, received, now);
}

void Ft232r::answer(const Bytes& bytes, double received, double now) {
  double ready = now;
  if (wall_) {  // an echo runs along with what it echoes; a reply of 16 bytes begins after its request
    const double sent = received + 10 * static_cast<double>(std::min(bytes.size(), kReply)) / baud_;
    ready = std::ceil(sent / kFrame) * kFrame;
  }
  ready += faults_.latency * 1e-3;
  const bool joined = faults_.join != 0 && !fifo_.empty();
  if (joined) {
    for (Byte& byte : fifo_) byte.ready = ready;
  } else if (faults_.join != 0) {
    ready += kJoinWait;
  }
  for (std::size_t i = 0; i < bytes.size(); ++i)
    fifo_.push_back({bytes[i], faults_.split != 0 && i + 1 == kSplitAt, ready});
}

void Ft232r::put(const Bytes& bytes, double now) {
  for (const std::uint8_t byte : bytes) fifo_.push_back({byte, false, now});
}

std::size_t Ft232r::ready_bytes(double now) const {
  const auto late = std::ranges::find_if(fifo_, [now](const Byte& b) { return b.ready > now; });
  return static_cast<std::size_t>(late - fifo_.begin());
}

void Ft232r::append_status(Bytes& transfer) const {
  transfer.push_back(static_cast<std::uint8_t>(kStatusAlways | (line_.clear_to_send() ? kCts : 0)));
  transfer.push_back(kSenderEmpty);
}

void Ft232r::append_packet(Bytes& transfer, double now) {
  append_status(transfer);
  for (std::size_t i = std::min(kPayload, ready_bytes(now)); i > 0; --i) {
    const Byte byte = fifo_.front();
    fifo_.pop_front();
    transfer.push_back(byte.value);
    if (byte.last) break;
  }
}

std::optional<UsbResult> Ft232r::read(std::size_t size, double now) {
  if (faults_.hang != 0) return std::nullopt;
  if (faults_.zero_in > 0) {
    --faults_.zero_in;
    return UsbResult{};
  }
  const bool timer = now >= last_sent_ + latency_;
  const std::size_t ready = ready_bytes(now);
  const bool data = ready >= kPayload || (ready > 0 && (timer || latency_ <= kFrame));
  if (!data && !timer) return std::nullopt;
  UsbResult result;
  last_sent_ = now;
  if (data && flooded_ < faults_.status_flood) {
    ++flooded_;
    append_status(result.data);
  } else {
    std::size_t before = 0;
    do {
      before = result.data.size();
      append_packet(result.data, now);
    } while (result.data.size() - before == kPacket && result.data.size() < size);
    if (result.data.size() - before > 2) flooded_ = 0;
  }
  if (result.data.size() > size) {
    result.data.resize(size);
    result.status = -EOVERFLOW;
  }
  return result;
}

double Ft232r::wake_at() const {
  if (faults_.hang != 0) return UsbDevice::kNever;
  const double timer = last_sent_ + latency_;
  if (latency_ > kFrame || fifo_.empty()) return timer;
  return std::min(timer, fifo_.front().ready);
}

}  // namespace palpate::emulation
