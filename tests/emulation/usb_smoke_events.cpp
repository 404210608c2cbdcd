// Transfers that end otherwise than by data: unplugged, timed out, cancelled, many at once.
#include "tests/emulation/usb_smoke.h"

namespace palpate::usb_smoke {
namespace {

int LIBUSB_CALL on_hotplug(libusb_context*, libusb_device* device, libusb_hotplug_event event, void* count) {
  std::printf("%s %d-%d\n", event == LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED ? "arrived" : "left",
              libusb_get_bus_number(device), libusb_get_port_number(device));
  ++*static_cast<int*>(count);
  return 0;
}

void LIBUSB_CALL on_transfer(libusb_transfer* transfer) {
  *static_cast<int*>(transfer->user_data) = 1 + transfer->status;
}

struct Storm {
  int remaining, running = 0;
  static void LIBUSB_CALL on_end(libusb_transfer* transfer) {
    auto& storm = *static_cast<Storm*>(transfer->user_data);
    --storm.running;
    if (transfer->status != LIBUSB_TRANSFER_COMPLETED || storm.remaining <= 0) return;
    --storm.remaining;
    if (libusb_submit_transfer(transfer) == 0) ++storm.running;
  }
};

}  // namespace

void hotplug(const Context& context) {
  int events = 0, ended = 0;
  libusb_hotplug_callback_handle callback = 0;
  checked(libusb_hotplug_register_callback(
              context.usb, LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED | LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT, 0, 0x0403,
              0xcb48, LIBUSB_HOTPLUG_MATCH_ANY, on_hotplug, &events, &callback),
          "hotplug");
  {
    const Handle device(context, 0x0403, 0xcb48);
    device.claim();
    ftdi(device, 9, 255);
    std::uint8_t buffer[64];
    libusb_transfer* transfer = libusb_alloc_transfer(0);
    libusb_fill_bulk_transfer(transfer, device.usb, kIn, buffer, sizeof buffer, on_transfer, &ended, 0);
    for (ended = 1; ended == 1;) {  // status only: again
      ended = 0;
      checked(libusb_submit_transfer(transfer), "submit");
      std::printf("waiting\n");
      while (ended == 0) libusb_handle_events_completed(context.usb, &ended);
    }
    std::printf("transfer_status %d\n", ended - 1);
    libusb_free_transfer(transfer);
    int moved = 0;
    std::printf("after %s\n",
                libusb_error_name(libusb_bulk_transfer(device.usb, kOut, buffer, 1, &moved, 100)));
  }
  while (events < 2) libusb_handle_events_completed(context.usb, nullptr);
  const Handle again(context, 0x0403, 0xcb48);
  again.claim();
  std::printf("open_again 1\n");
}

void timeouts(const Context& context) {
  const Handle device(context, 0x0403, 0xcb48);
  device.claim();
  for (int i = 0; i < 2; ++i) {
    std::uint8_t packet[64];
    int moved = 0;
    std::printf("timeout %s\n",
                libusb_error_name(libusb_bulk_transfer(device.usb, kIn, packet, sizeof packet, &moved, 50)));
  }
}

/// Keeps 64 transfers under way, more than libusb reaps at once, until `count` have ended; then cancels the
/// rest.
void storm(const Context& context, int count) {
  const Handle device(context, 0x0403, 0xcb48);
  device.claim();
  ftdi(device, 9, 1);
  Storm storm{count};
  std::vector<Bytes> buffers(64, Bytes(64));
  std::vector<libusb_transfer*> transfers;
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    transfers.push_back(libusb_alloc_transfer(0));
    libusb_fill_bulk_transfer(transfers[i], device.usb, i % 8 == 0 ? kIn : kOut, buffers[i].data(), 64,
                              Storm::on_end, &storm, 0);
    storm.running += libusb_submit_transfer(transfers[i]) == 0 ? 1 : 0;
  }
  timeval second{1, 0};
  while (storm.remaining > 0) libusb_handle_events_timeout(context.usb, &second);
  for (libusb_transfer* transfer : transfers) libusb_cancel_transfer(transfer);
  while (storm.running > 0) libusb_handle_events_timeout(context.usb, &second);
  for (libusb_transfer* transfer : transfers) libusb_free_transfer(transfer);
  std::printf("storm_over %d\n", storm.running);
}

}  // namespace palpate::usb_smoke
