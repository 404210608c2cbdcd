#include "haptic_client/device/usb_port.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <libusb-1.0/libusb.h>

#include "common/error.h"
#include "common/spsc_ring.h"
#include "haptic_client/device/falcon_packets.h"

namespace palpate::client {
namespace {

constexpr int kInterface = 0;
constexpr std::uint8_t kIn = 0x81, kOut = 0x02;
constexpr std::uint8_t kVendorOut = 0x40;  // bmRequestType
constexpr unsigned kTimeout = 1000;        // ms, of OUT and control
constexpr std::size_t kInSize = 512, kPending = 2, kReceived = 4096;

std::string path_of(libusb_device* device) {
  std::array<std::uint8_t, 8> ports{};
  const int count = libusb_get_port_numbers(device, ports.data(), static_cast<int>(ports.size()));
  std::string path = fmt::format("{}", libusb_get_bus_number(device));
  for (int i = 0; i < count; ++i)
    path += fmt::format("{}{}", i == 0 ? '-' : '.', ports[static_cast<std::size_t>(i)]);
  return path;
}

const char* in_words(int error) {
  switch (error) {
    case LIBUSB_ERROR_ACCESS:
      return "no permission for the USB device; `haptic_client devices` prints the udev rule that gives it";
    case LIBUSB_ERROR_BUSY:
      return "another program holds the USB device; end it";
    case LIBUSB_ERROR_NO_DEVICE:
      return "";
    default:
      return "the USB device cannot be opened; unplug it and plug it in again";
  }
}

template <class Use>
void for_each(libusb_context* context, std::uint16_t vendor, std::uint16_t product, Use use) {
  libusb_device** list = nullptr;
  const auto count = libusb_get_device_list(context, &list);
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(list[i], &descriptor) != 0) continue;
    if (descriptor.idVendor == vendor && descriptor.idProduct == product) use(list[i]);
  }
  if (list != nullptr) libusb_free_device_list(list, 1);
}

libusb_context* begin_usb() {
  libusb_context* context = nullptr;
  if (const int error = libusb_init(&context); error != 0)
    fail_at_run_time("USB cannot be used ({})", libusb_strerror(static_cast<libusb_error>(error)));
  return context;
}

}  // namespace

std::vector<UsbDevice> find_usb(std::uint16_t vendor, std::uint16_t product) {
  libusb_context* context = begin_usb();
  std::vector<UsbDevice> found;
  for_each(context, vendor, product, [&](libusb_device* device) {
    UsbDevice row{path_of(device), vendor, product, ""};
    libusb_device_handle* handle = nullptr;
    if (const int error = libusb_open(device, &handle); error != 0) row.access = in_words(error);
    if (handle != nullptr) libusb_close(handle);
    found.push_back(row);
  });
  libusb_exit(context);
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.path < b.path; });
  return found;
}

struct UsbPort::Libusb {
  struct Incoming {
    Libusb* owner = nullptr;
    libusb_transfer* transfer = nullptr;
    bool flying = false;
    std::array<unsigned char, kInSize> bytes{};
  };

  std::uint16_t vendor, product;
  std::string path;
  libusb_context* context = nullptr;
  libusb_device_handle* handle = nullptr;
  std::array<Incoming, kPending> incoming{};
  SpscRing<std::byte> received{kReceived};
  libusb_transfer* out = nullptr;  // one at a time, made once: a tick does not allocate
  std::array<unsigned char, kFtdiUsbPacket> out_bytes{};
  bool out_flying = false;
  int controls = 0;  // requests on the way
  bool lost = false, closing = false;
  const char* trouble = "";

  bool submit(libusb_transfer* transfer) {
    if (libusb_submit_transfer(transfer) == 0) return true;
    lost = true;
    return false;
  }

  static void on_in(libusb_transfer* transfer) {
    auto& in = *static_cast<Incoming*>(transfer->user_data);
    Libusb& self = *in.owner;
    in.flying = false;
    if (transfer->status == LIBUSB_TRANSFER_COMPLETED) {
      std::array<std::byte, kInSize> payload;
      const auto* begin = reinterpret_cast<const std::byte*>(in.bytes.data());
      const std::size_t size =
          strip_ftdi_status({begin, static_cast<std::size_t>(transfer->actual_length)}, payload);
      for (std::size_t i = 0; i < size; ++i) self.received.push(payload[i]);
      in.flying = !self.lost && !self.closing && self.submit(transfer);
    } else if (transfer->status != LIBUSB_TRANSFER_CANCELLED) {
      self.lost = true;
    }
  }

  /// OUT and control: `user_data` is the owner; libusb frees the transfer and the buffer of a request.
  static void on_out(libusb_transfer* transfer) {
    auto& self = *static_cast<Libusb*>(transfer->user_data);
    if (transfer == self.out) {
      self.out_flying = false;
    } else {
      --self.controls;
    }
    const bool done = transfer->status == LIBUSB_TRANSFER_COMPLETED;
    if (!done && transfer->status != LIBUSB_TRANSFER_CANCELLED) self.lost = true;
  }

  void handle_events(long microseconds) {
    timeval wait{0, microseconds};
    libusb_handle_events_timeout_completed(context, &wait, nullptr);
  }

  bool flying() const {
    return out_flying || controls > 0 ||
           std::any_of(incoming.begin(), incoming.end(), [](const Incoming& in) { return in.flying; });
  }
};

UsbPort::UsbPort(std::uint16_t vendor, std::uint16_t product, std::string path)
    : usb_(new Libusb{.vendor = vendor, .product = product, .path = std::move(path)}) {
  usb_->context = begin_usb();
}

UsbPort::~UsbPort() {
  close();
  libusb_exit(usb_->context);
}

bool UsbPort::open() noexcept {
  Libusb& u = *usb_;
  close();
  int error = LIBUSB_ERROR_NO_DEVICE;
  for_each(u.context, u.vendor, u.product, [&](libusb_device* device) {
    if (u.handle == nullptr && (u.path.empty() || path_of(device) == u.path))
      error = libusb_open(device, &u.handle);
  });
  if (error == 0) {
    libusb_set_auto_detach_kernel_driver(u.handle, 1);
    error = libusb_claim_interface(u.handle, kInterface);
  }
  u.trouble = error == 0 ? "" : in_words(error);
  if (error != 0) {
    close();
    return false;
  }
  u.out = libusb_alloc_transfer(0);
  for (auto& in : u.incoming) {
    in.owner = &u;
    in.transfer = libusb_alloc_transfer(0);
    libusb_fill_bulk_transfer(in.transfer, u.handle, kIn, in.bytes.data(), static_cast<int>(in.bytes.size()),
                              &Libusb::on_in, &in, 0);
    in.flying = u.submit(in.transfer);
  }
  return !u.lost;
}

/// Whatever is on the way is called back, within a second.
void UsbPort::close() noexcept {
  Libusb& u = *usb_;
  constexpr int kRounds = 100;
  constexpr long kRound = 10'000;  // us
  u.closing = true;                // what completes now is not asked for again
  for (auto& in : u.incoming) {
    if (in.flying) libusb_cancel_transfer(in.transfer);
  }
  for (int i = 0; i < kRounds && u.flying(); ++i) u.handle_events(kRound);
  for (auto& in : u.incoming) {
    if (in.transfer != nullptr && !in.flying) libusb_free_transfer(in.transfer);
    in.transfer = nullptr;
    in.flying = false;
  }
  if (u.out != nullptr && !u.out_flying) libusb_free_transfer(u.out);
  u.out = nullptr;
  if (u.handle != nullptr) {
    libusb_release_interface(u.handle, kInterface);
    libusb_close(u.handle);
  }
  u.handle = nullptr;
  u.controls = 0;
  u.out_flying = false;
  u.lost = u.closing = false;
  for (std::byte b; u.received.pop(b);) {
  }
}

void UsbPort::control(std::uint8_t request, std::uint16_t value) noexcept {
  Libusb& u = *usb_;
  if (u.handle == nullptr || u.lost) return;
  auto* setup = static_cast<unsigned char*>(std::malloc(LIBUSB_CONTROL_SETUP_SIZE));
  libusb_transfer* transfer = libusb_alloc_transfer(0);
  libusb_fill_control_setup(setup, kVendorOut, request, value, 0, 0);
  libusb_fill_control_transfer(transfer, u.handle, setup, &Libusb::on_out, &u, kTimeout);
  transfer->flags = LIBUSB_TRANSFER_FREE_BUFFER | LIBUSB_TRANSFER_FREE_TRANSFER;
  if (u.submit(transfer)) ++u.controls;
}

bool UsbPort::write(std::span<const std::byte> bytes) noexcept {
  Libusb& u = *usb_;
  if (u.handle == nullptr || u.lost || u.out_flying || bytes.size() > u.out_bytes.size()) return false;
  std::copy(bytes.begin(), bytes.end(), reinterpret_cast<std::byte*>(u.out_bytes.data()));
  libusb_fill_bulk_transfer(u.out, u.handle, kOut, u.out_bytes.data(), static_cast<int>(bytes.size()),
                            &Libusb::on_out, &u, kTimeout);
  u.out_flying = u.submit(u.out);
  return u.out_flying;
}

std::size_t UsbPort::read(std::span<std::byte> out) noexcept {
  Libusb& u = *usb_;
  if (u.handle == nullptr) return 0;
  u.handle_events(0);
  std::size_t size = 0;
  while (size < out.size() && u.received.pop(out[size])) ++size;
  return size;
}

UsbTransport::State UsbPort::state() const noexcept {
  const Libusb& u = *usb_;
  if (u.handle == nullptr) return State::kClosed;
  if (u.lost) return State::kLost;
  return u.out_flying || u.controls > 0 ? State::kBusy : State::kIdle;
}

const char* UsbPort::trouble() const noexcept {
  return usb_->trouble;
}

}  // namespace palpate::client
