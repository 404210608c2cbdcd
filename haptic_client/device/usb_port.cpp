#include "haptic_client/device/usb_port.h"

#include <algorithm>
#include <array>
#include <libusb-1.0/libusb.h>

#include "common/clock.h"
#include "common/spsc_ring.h"
#include "haptic_client/device/usb_lookout.h"

namespace palpate::client {
namespace {

constexpr unsigned kTimeout = 1000;                          // ms, of OUT and control
constexpr std::size_t kPending = 4, kReceived = 64;          // IN transfers; packets that wait to be read
constexpr std::size_t kRequests = 16;                        // on the way at once
constexpr std::uint8_t kToInterface = 1, kRecipient = 0x1f;  // of bmRequestType

constexpr const char* kFailed = "a USB transfer failed (cable, hub?); opening the device again";

}  // namespace

struct UsbPort::Libusb {
  /// A transfer and its bytes, made once an opening: a tick does not allocate.
  struct Transfer {
    Libusb* owner = nullptr;
    libusb_transfer* libusb = nullptr;
    bool flying = false, optional = false;
    std::array<unsigned char, kMostUsbIn> bytes{};
  };
  struct Packet {
    std::size_t size = 0;
    std::array<std::byte, kMostUsbIn> bytes{};
  };

  UsbKind kind;
  std::string wanted;  // path
  libusb_context* context = nullptr;
  libusb_device_handle* handle = nullptr;
  UsbPath path{};
  UsbInterface interface {};
  std::array<Transfer, kPending> incoming{};
  Transfer out{};
  std::array<Transfer, kRequests> requests{};
  SpscRing<Packet> received{kReceived};
  UsbLookout lookout{false};
  bool lost = false, closing = false;
  const char* trouble = "";

  /// Opens this device and claims its interface; 0 or libusb's error.
  int claim(libusb_device* device) {
    const auto chosen = choose_interface(device, kind.hid);
    if (!chosen) return LIBUSB_ERROR_NOT_SUPPORTED;
    int error = libusb_open(device, &handle);
    if (error != 0) return error;
    libusb_set_auto_detach_kernel_driver(handle, 1);
    error = libusb_claim_interface(handle, chosen->number);
    if (error != 0) {
      libusb_close(handle);
      handle = nullptr;
      return error;
    }
    interface = *chosen;
    path = path_of(device);
    return 0;
  }

  void listen() {
    constexpr int kBoth = LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED | LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT;
    constexpr int kAny = LIBUSB_HOTPLUG_MATCH_ANY;
    const int error =
        libusb_hotplug_register_callback(context, kBoth, 0, kAny, kAny, kAny, &on_hotplug, this, nullptr);
    lookout = UsbLookout(error == 0);
  }

  /// Called while events are handled, in the haptic thread; may not open anything.
  static int on_hotplug(libusb_context*, libusb_device* device, libusb_hotplug_event event, void* owner) {
    auto& self = *static_cast<Libusb*>(owner);
    if (event == LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED) {
      self.lookout.poll();
    } else if (self.handle != nullptr && libusb_get_device(self.handle) == device) {
      self.lost = true;
      self.trouble = "";
    }
    return 0;
  }

  void lose(const char* why) {
    if (!lost) trouble = why;
    lost = true;
  }

  bool submit(Transfer& transfer) {
    const int error = libusb_submit_transfer(transfer.libusb);
    transfer.flying = error == 0;
    if (error != 0) lose(error == LIBUSB_ERROR_NO_DEVICE ? "" : kFailed);
    return transfer.flying;
  }

  void lose_with(const libusb_transfer& ended) {
    if (ended.status != LIBUSB_TRANSFER_CANCELLED)
      lose(ended.status == LIBUSB_TRANSFER_NO_DEVICE ? "" : kFailed);
  }

  static void on_in(libusb_transfer* transfer) {
    auto& in = *static_cast<Transfer*>(transfer->user_data);
    Libusb& self = *in.owner;
    in.flying = false;
    if (transfer->status == LIBUSB_TRANSFER_COMPLETED) {
      Packet* const packet = transfer->actual_length > 0 ? self.received.claim() : nullptr;
      if (packet != nullptr) {
        packet->size = static_cast<std::size_t>(transfer->actual_length);
        std::copy_n(reinterpret_cast<const std::byte*>(in.bytes.data()), packet->size, packet->bytes.begin());
        self.received.publish();
      }
      if (!self.lost && !self.closing) self.submit(in);
    } else {
      self.lose_with(*transfer);
    }
  }

  /// OUT and control.
  static void on_out(libusb_transfer* transfer) {
    auto& out = *static_cast<Transfer*>(transfer->user_data);
    out.flying = false;
    const bool refused = out.optional && transfer->status == LIBUSB_TRANSFER_STALL;
    const bool done = transfer->status == LIBUSB_TRANSFER_COMPLETED || refused;
    if (!done) out.owner->lose_with(*transfer);
  }

  /// Bulk or interrupt, as the endpoint is.
  void fill(Transfer& transfer, const UsbEndpoint& endpoint, std::size_t size, libusb_transfer_cb_fn done,
            unsigned timeout) {
    libusb_fill_bulk_transfer(transfer.libusb, handle, endpoint.address, transfer.bytes.data(),
                              static_cast<int>(size), done, &transfer, timeout);
    transfer.libusb->type = endpoint.type;
  }

  template <class Use>
  void for_each_transfer(Use use) {
    for (Transfer& transfer : incoming) use(transfer);
    use(out);
    for (Transfer& transfer : requests) use(transfer);
  }

  void handle_events(long microseconds) {
    timeval wait{0, microseconds};
    libusb_handle_events_timeout_completed(context, &wait, nullptr);
  }

  bool sending() const {
    return out.flying || std::ranges::any_of(requests, [](const auto& t) { return t.flying; });
  }
  bool flying() const {
    return sending() || std::ranges::any_of(incoming, [](const auto& t) { return t.flying; });
  }
};

UsbPort::UsbPort(UsbKind kind, std::string path) : usb_(new Libusb{.kind = kind, .wanted = std::move(path)}) {
  usb_->context = start_usb();
  usb_->listen();
}

UsbPort::~UsbPort() {
  UsbPort::close();
  libusb_exit(usb_->context);
}

bool UsbPort::open(Time now) noexcept {
  Libusb& u = *usb_;
  close();
  u.handle_events(0);  // tells what was plugged in
  if (!u.lookout.due(now)) return false;
  int error = LIBUSB_ERROR_NO_DEVICE;
  for_each_usb(u.context, u.kind.ids, [&](libusb_device* device, const UsbId&) {
    if (u.handle == nullptr && (u.wanted.empty() || path_of(device).data() == u.wanted))
      error = u.claim(device);
  });
  u.trouble = error == 0 ? "" : in_words(error);
  if (error != 0) {
    u.lookout.failed(now, error == LIBUSB_ERROR_NO_DEVICE);
    return false;
  }
  u.for_each_transfer([&](Libusb::Transfer& transfer) {
    transfer.owner = &u;
    transfer.libusb = libusb_alloc_transfer(0);
  });
  for (auto& in : u.incoming) {
    u.fill(in, u.interface.in, u.interface.in.size, &Libusb::on_in, 0);
    u.submit(in);
  }
  if (!u.lost) return true;
  close();
  u.lookout.failed(now, false);
  return false;
}

/// Whatever is on the way is called back, within a second.
void UsbPort::close() noexcept {
  Libusb& u = *usb_;
  if (u.handle == nullptr) return;
  // For transfers that were cancelled; libusb ends them at the next event.
  constexpr Time kPatience = std::chrono::seconds(1);
  constexpr long kRound = 10'000;  // us
  u.closing = true;                // what completes now is not asked for again
  for (auto& in : u.incoming) {
    if (in.flying) libusb_cancel_transfer(in.libusb);
  }
  for (const Time end = now() + kPatience; u.flying() && now() < end;) u.handle_events(kRound);
  u.for_each_transfer([](Libusb::Transfer& transfer) {
    if (!transfer.flying) libusb_free_transfer(transfer.libusb);
    transfer.libusb = nullptr;
    transfer.flying = false;
  });
  libusb_release_interface(u.handle, u.interface.number);
  libusb_close(u.handle);
  u.handle = nullptr;
  u.lookout.poll();
  u.path = {};
  u.lost = u.closing = false;
  while (u.received.front() != nullptr) u.received.release();
}

void UsbPort::control(const UsbRequest& request) noexcept {
  Libusb& u = *usb_;
  if (u.handle == nullptr || u.lost) return;
  const auto free = std::ranges::find_if(u.requests, [](const auto& t) { return !t.flying; });
  if (free == u.requests.end() || request.data.size() > kFullSpeedPacket) return u.lose(kFailed);
  const bool to_interface = (request.type & kRecipient) == kToInterface;
  const auto index = to_interface ? static_cast<std::uint16_t>(u.interface.number) : request.index;
  unsigned char* const bytes = free->bytes.data();
  libusb_fill_control_setup(bytes, request.type, request.request, request.value, index,
                            static_cast<std::uint16_t>(request.data.size()));
  std::ranges::copy(request.data, reinterpret_cast<std::byte*>(bytes + LIBUSB_CONTROL_SETUP_SIZE));
  libusb_fill_control_transfer(free->libusb, u.handle, bytes, &Libusb::on_out, &*free, kTimeout);
  free->optional = request.optional;
  u.submit(*free);
}

bool UsbPort::write(std::span<const std::byte> bytes) noexcept {
  Libusb& u = *usb_;
  if (u.handle == nullptr || u.lost || u.out.flying) return false;
  if (u.interface.out.address == 0 || bytes.size() > kFullSpeedPacket) return false;
  std::ranges::copy(bytes, reinterpret_cast<std::byte*>(u.out.bytes.data()));
  u.fill(u.out, u.interface.out, bytes.size(), &Libusb::on_out, kTimeout);
  return u.submit(u.out);
}

std::size_t UsbPort::read(std::span<std::byte> out) noexcept {
  Libusb& u = *usb_;
  if (u.handle == nullptr) return 0;
  u.handle_events(0);
  const Libusb::Packet* const packet = u.received.front();
  if (packet == nullptr) return 0;
  const std::size_t size = std::min(packet->size, out.size());
  std::copy_n(packet->bytes.begin(), size, out.begin());
  u.received.release();
  return size;
}

UsbTransport::State UsbPort::state() const noexcept {
  const Libusb& u = *usb_;
  if (u.handle == nullptr) return State::kClosed;
  if (u.lost) return State::kLost;
  return u.sending() ? State::kBusy : State::kIdle;
}

const char* UsbPort::trouble() const noexcept {
  return usb_->trouble;
}

const char* UsbPort::path() const noexcept {
  return usb_->path.data();
}

}  // namespace palpate::client
