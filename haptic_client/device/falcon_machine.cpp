#include "haptic_client/device/falcon_machine.h"

#include <algorithm>

namespace palpate::client {
namespace {

using namespace std::chrono_literals;
using Bytes = std::span<const std::byte>;

// FTDI vendor requests and their values (baud rate = 3 MHz / divisor).
enum FtdiRequest : std::uint8_t { kReset = 0, kModem = 1, kFlow = 2, kBaud = 3, kLine = 4, kLatency = 9 };
constexpr std::uint16_t kPurgeIn = 1, kPurgeOut = 2, kDtrLow = 0x0100, kDtrHigh = 0x0101, kRtsLow = 0x0200;
constexpr std::uint16_t kBaud9600 = 0x4138, kBaud140k = 0x0015, kBaud1500k = 0x0002, k8N1 = 0x0008;
constexpr std::uint16_t kLatencyBoot = 16, kLatencyRun = 1;  // ms

constexpr std::array kAreYouThere{std::byte{0x0a}, std::byte{0x43}, std::byte{0x0d}};
constexpr std::array kIAm{std::byte{0x0a}, std::byte{0x44}, std::byte{0x2c}, std::byte{0x0d}};
constexpr std::array kReadyForImage{std::byte{0x41}};

constexpr std::uint8_t kVendor = 0x40;  // bmRequestType

void ftdi(UsbTransport& port, FtdiRequest request, std::uint16_t value) {
  port.control({.type = kVendor, .request = request, .value = value});
}

// Until a packet is sent again; until a missing answer starts the upload again. The 62 bytes of a chunk take
// 4.4 ms at 140 kBaud, and their echo as long.
constexpr Time kProbePeriod = 20ms, kBootPeriod = 60ms, kHandshakePatience = 300ms, kEchoPatience = 500ms;
constexpr Time kLongestSilence = 1s;                   // without a status packet: opens the device again
constexpr Time kFresh = 50ms;                          // an older status gives no position
constexpr Time kSearchAgain = 500ms, kLoadAgain = 2s;  // until a closed device is opened
// Packets without an answer: for 0.5 s, then the firmware is missing; for 6 s, then the reset is tried again.
constexpr int kProbes = 25, kBootTries = 100;
constexpr int kLoads = 5;  // uploads in a row until the image counts as wrong
constexpr const char* kHomeIt =
    "Falcon: pull the grip fully out, then push it fully in, to home it; if its light stays red, check that "
    "its mains adaptor is plugged in";
constexpr const char* kUnplugged = "the Falcon was unplugged; plug it in again";
constexpr const char* kFrozen =
    "no encoder of the Falcon moved for 3 s under force; if the hand did, unplug it and plug it in again";
constexpr const char* kFading =
    "no encoder of the Falcon moved for as long as `frozen_fade` allows: its force fades until one does; if "
    "the "
    "hand moves, unplug it and plug it in again";
constexpr const char* kMovesAgain = "the Falcon moves again: its force rises";
constexpr double kFadeTime = 1;         // s, from all of the force to none and back
constexpr int kPacketsATick = 64;       // more than the bus carries in a tick: a flood does not hold it up
constexpr Time kUnmoved = 3s;           // a hand that holds against a force is never so still
constexpr std::int16_t kPushing = 200;  // DAC units: more than what friction holds

}  // namespace

void FalconMachine::enter(FalconPhase phase, Time now) noexcept {
  phase_ = phase;
  times_.entered = times_.heard = now;
  gain_ = 1;
  times_.ran = Time::zero();
  requested_ = false;
  tries_ = 0;
  answered_ = 0;
  stream_.clear();
  status_.reset();
}

void FalconMachine::poll(UsbTransport& port, Time now) noexcept {
  if (phase_ != FalconPhase::kClosed && port.state() == UsbTransport::State::kLost) return lose(port, now);
  take(port, now);
  switch (phase_) {
    case FalconPhase::kClosed:
      return begin(port, now);
    case FalconPhase::kProbe:
      return probe(port, now);
    case FalconPhase::kBoot:
      return boot(port, now);
    case FalconPhase::kHandshake:
      return handshake(port, now);
    case FalconPhase::kUpload:
      return upload(port, now);
    case FalconPhase::kUnhomed:
    case FalconPhase::kReady:
      return run(port, now);
  }
}

/// Packets while firmware runs, raw bytes while the boot loader does.
void FalconMachine::take(UsbTransport& port, Time now) noexcept {
  if (phase_ == FalconPhase::kClosed) return;
  const bool packets =
      phase_ == FalconPhase::kProbe || phase_ == FalconPhase::kUnhomed || phase_ == FalconPhase::kReady;
  std::array<std::byte, kFtdiUsbPacket> packet, bytes;
  for (int i = 0; i < kPacketsATick; ++i) {
    const std::size_t size = port.read(packet);
    if (size == 0) return;
    const Bytes came(bytes.data(), strip_ftdi_status({packet.data(), size}, bytes));
    if (packets) {
      stream_.push(came, [&](const FalconStatus& status) {
        if (!status_ || status.encoder != status_->encoder) times_.moved = now;
        status_ = status;
        times_.heard = now;
      });
    } else {
      const std::size_t room = std::min(came.size(), answer_.size() - answered_);
      std::copy_n(came.begin(), room, answer_.begin() + static_cast<std::ptrdiff_t>(answered_));
      answered_ += room;
    }
  }
}

void FalconMachine::begin(UsbTransport& port, Time now) noexcept {
  if (now < times_.retry_at) return;
  if (!port.open(now)) {
    if (port.trouble()[0] != 0) {
      message_ = port.trouble();
    } else if (known_) {
      message_ = kUnplugged;
    }
    return;
  }
  known_ = true;
  loads_ = 0;
  normal_mode(port);
  enter(FalconPhase::kProbe, now);
}

void FalconMachine::normal_mode(UsbTransport& port) noexcept {
  ftdi(port, kLatency, kLatencyRun);
  ftdi(port, kBaud, kBaud1500k);
  ftdi(port, kReset, kPurgeIn);
  ftdi(port, kReset, kPurgeOut);
}

/// The edge of DTR resets the microcontroller into its boot loader.
void FalconMachine::boot_mode(UsbTransport& port, Time now) noexcept {
  if (++loads_ > kLoads) {
    failing_ = true;
    return give_up(
        port, now, kLoadAgain,
        "the Falcon does not take its firmware; trying again: is the image the right file? Else try "
        "another USB port, or a powered hub");
  }
  ftdi(port, kReset, kPurgeIn);
  ftdi(port, kReset, kPurgeOut);
  ftdi(port, kLatency, kLatencyBoot);
  ftdi(port, kBaud, kBaud9600);
  ftdi(port, kLine, k8N1);
  ftdi(port, kFlow, 0);
  ftdi(port, kModem, kRtsLow);
  ftdi(port, kModem, kDtrLow);
  ftdi(port, kModem, kDtrHigh);
  if (!failing_) message_ = "loading the Falcon's firmware";
  enter(FalconPhase::kBoot, now);
}

void FalconMachine::probe(UsbTransport& port, Time now) noexcept {
  if (!requested_) {  // what came before the first question is of another session
    stream_.clear();
    status_.reset();
  }
  if (status_) {
    failing_ = false;
    if (!status_->all_homed()) message_ = kHomeIt;
    return enter(FalconPhase::kUnhomed, now);
  }
  if (requested_ && now - times_.sent < kProbePeriod) return;
  if (tries_ < kProbes) {
    if (send(port, encode_falcon({}), now)) ++tries_;
    return;
  }
  if (firmware_.empty())
    return give_up(port, now, kLoadAgain,
                   "the Falcon has no firmware yet; give one with --falcon-firmware PATH");
  boot_mode(port, now);
}

void FalconMachine::boot(UsbTransport& port, Time now) noexcept {
  const auto end = answer_.begin() + static_cast<std::ptrdiff_t>(answered_);
  if (std::search(answer_.begin(), end, kIAm.begin(), kIAm.end()) != end) {
    ftdi(port, kModem, kDtrLow);
    ftdi(port, kBaud, kBaud140k);
    return enter(FalconPhase::kHandshake, now);
  }
  if (requested_ && now - times_.sent < kBootPeriod) return;
  if (tries_ == kBootTries) return boot_mode(port, now);
  answered_ = 0;
  if (send(port, kAreYouThere, now)) ++tries_;
}

void FalconMachine::handshake(UsbTransport& port, Time now) noexcept {
  const auto end = answer_.begin() + static_cast<std::ptrdiff_t>(answered_);
  if (requested_ && std::find(answer_.begin(), end, kReadyForImage[0]) != end) {
    uploaded_ = 0;
    return enter(FalconPhase::kUpload, now);
  }
  if (!requested_) {
    answered_ = 0;
    send(port, kReadyForImage, now);
  }
  if (now - times_.entered > kHandshakePatience) boot_mode(port, now);
}

void FalconMachine::upload(UsbTransport& port, Time now) noexcept {
  const std::size_t size = std::min(kChunk, firmware_.size() - uploaded_);
  const Bytes chunk(firmware_.data() + uploaded_, size);
  if (requested_ && answered_ >= size) {
    if (answered_ > size || !std::equal(chunk.begin(), chunk.end(), answer_.begin()))
      return boot_mode(port, now);
    uploaded_ += size;
    answered_ = 0;
    requested_ = false;
    if (uploaded_ == firmware_.size()) {
      normal_mode(port);
      return enter(FalconPhase::kProbe, now);
    }
    return upload(port, now);
  }
  if (requested_ && now - times_.sent > kEchoPatience) return boot_mode(port, now);
  if (!requested_) send(port, chunk, now);
}

void FalconMachine::run(UsbTransport& port, Time now) noexcept {
  if (now - times_.heard > kLongestSilence)
    return give_up(port, now, kSearchAgain, "the Falcon stopped answering; trying again");
  if (!status_) return;
  if (phase_ == FalconPhase::kUnhomed && status_->all_homed()) {
    message_ = "Falcon homed: ready";
    phase_ = FalconPhase::kReady;
  } else if (phase_ == FalconPhase::kReady && !status_->all_homed()) {
    message_ = "the Falcon lost its home: pull the grip fully out, then push it fully in";
    phase_ = FalconPhase::kUnhomed;
  }
  watch_encoders(now);
}

/// Tells of encoders that stand still under force; where that was asked for, the force fades with them, and
/// rises again when one moves.
void FalconMachine::watch_encoders(Time now) noexcept {
  if (!pushes_) times_.moved = now;
  const double dt = times_.ran > Time::zero() ? to_seconds(now - times_.ran) : 0;
  times_.ran = now;
  if (frozen_fade_ == Time::zero()) {
    if (now - times_.moved > kUnmoved) message_ = kFrozen;
    return;
  }
  const bool frozen = now - times_.moved > frozen_fade_;
  if (frozen) message_ = kFading;
  if (!frozen && message_ == kFading) message_ = kMovesAgain;
  gain_ = std::clamp(gain_ + (frozen ? -dt : dt) / kFadeTime, 0.0, 1.0);
}

bool FalconMachine::command(UsbTransport& port, const std::array<std::int16_t, 3>& torque) noexcept {
  const bool ready = phase_ == FalconPhase::kReady;
  if (!ready && phase_ != FalconPhase::kUnhomed) return false;
  if (port.state() != UsbTransport::State::kIdle) return false;  // the last one is still on the way
  FalconCommand command{.green = ready, .red = !ready};
  if (ready) command.torque = torque;
  pushes_ =
      std::ranges::any_of(command.torque, [](std::int16_t t) { return t >= kPushing || t <= -kPushing; });
  for (std::int16_t& t : command.torque) t = static_cast<std::int16_t>(gain_ * t);
  if (zero_in_transit_) may_push_ = false;  // it has left
  const bool is_zero = command.torque == std::array<std::int16_t, 3>{};
  if (!is_zero) may_push_ = true;
  const bool went = port.write(encode_falcon(command));
  zero_in_transit_ = is_zero && went;
  return went;
}

std::optional<FalconStatus> FalconMachine::status(Time now) const noexcept {
  if (phase_ != FalconPhase::kReady || now - times_.heard > kFresh) return {};
  return status_;
}

void FalconMachine::lose(UsbTransport& port, Time now) noexcept {
  const char* const why = port.trouble();
  failing_ = false;
  // One that is still there may still push: it is taken up again soon, the first time.
  const bool soon = why[0] != 0 && (times_.lost == Time::zero() || now - times_.lost > kLoadAgain);
  times_.lost = now;
  give_up(port, now, soon ? kProbePeriod : kSearchAgain, why[0] != 0 ? why : kUnplugged);
}

void FalconMachine::give_up(UsbTransport& port, Time now, Time wait, const char* message) noexcept {
  port.close();
  zero_in_transit_ = false;  // it may not have left
  message_ = message;
  enter(FalconPhase::kClosed, now);
  times_.retry_at = now + wait;
}

/// Once requests and bytes before it are through, so that nothing overtakes a change of the line.
bool FalconMachine::send(UsbTransport& port, std::span<const std::byte> bytes, Time now) noexcept {
  if (port.state() != UsbTransport::State::kIdle || !port.write(bytes)) return false;
  requested_ = true;
  times_.sent = now;
  return true;
}

}  // namespace palpate::client
