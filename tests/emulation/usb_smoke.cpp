// usb_smoke: an ordinary program on libusb, to be run against emulated (or real) devices. It says what it
// sees, a line `key value` each. Exit code 0: everything went as it should.
#include "tests/emulation/usb_smoke.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>

using namespace palpate::usb_smoke;

namespace {

void send(const Handle& device, const Bytes& bytes) {
  int moved = 0;
  checked(libusb_bulk_transfer(device.usb, kOut, const_cast<std::uint8_t*>(bytes.data()),
                               static_cast<int>(bytes.size()), &moved, kTimeout),
          "send");
}

/// Payload until there are `size` bytes; throws after 100 transfers without.
Bytes receive(const Handle& device, std::size_t size) {
  Bytes all;
  for (int i = 0; i < 100 && all.size() < size; ++i) {
    std::uint8_t packet[64];
    int moved = 0;
    checked(libusb_bulk_transfer(device.usb, kIn, packet, sizeof packet, &moved, kTimeout), "receive");
    if (moved > 2) all.insert(all.end(), packet + 2, packet + moved);
  }
  if (all.size() < size) throw std::runtime_error("receive nothing");
  return all;
}

void run_mode(const Handle& device) {
  ftdi(device, 9, 1);
  ftdi(device, 3, 0x0002);
  ftdi(device, 0, 1);
  ftdi(device, 0, 2);
}

void load(const Handle& device) {
  ftdi(device, 9, 16);
  ftdi(device, 3, 0x4138);
  ftdi(device, 4, 8);
  ftdi(device, 1, 0x0200);
  ftdi(device, 1, 0x0100);
  ftdi(device, 1, 0x0101);
  send(device, {0x0a, 0x43, 0x0d});
  if (receive(device, 4) != Bytes{0x0a, 0x44, 0x2c, 0x0d}) throw std::runtime_error("greeting");
  ftdi(device, 1, 0x0100);
  ftdi(device, 3, 0x0015);
  send(device, {0x41});
  if (receive(device, 1) != Bytes{0x41}) throw std::runtime_error("start");
  std::uint32_t random = 12345;
  for (int sent = 0; sent < 8192;) {
    Bytes chunk;
    for (; chunk.size() < 62 && sent < 8192; ++sent)
      chunk.push_back(static_cast<std::uint8_t>((random = random * 1664525 + 1013904223) >> 24));
    send(device, chunk);
    if (receive(device, chunk.size()) != chunk) throw std::runtime_error("echo");
  }
  run_mode(device);
}

/// Sends a packet with no torque; returns the flags of the reply (buttons, references).
int exchange(const Handle& device, int flags) {
  send(device, Bytes{'<', 'A', 'A', 'A', 'A', 'A', 'A', 'A', 'A', 'A', 'A', 'A', 'A',
                     static_cast<std::uint8_t>('A' + flags), 'A', '>'});
  const Bytes reply = receive(device, 16);
  if (reply.size() != 16 || reply[0] != '<' || reply[15] != '>') throw std::runtime_error("reply");
  return reply[13] - 'A';
}

void list(const Context& context) {
  libusb_device** all = nullptr;
  const auto count = libusb_get_device_list(context.usb, &all);
  std::printf("devices %d\n", static_cast<int>(count));
  for (ssize_t i = 0; i < count; ++i) {
    libusb_device_descriptor d{};
    libusb_get_device_descriptor(all[i], &d);
    libusb_config_descriptor* config = nullptr;
    checked(libusb_get_active_config_descriptor(all[i], &config), "config");
    const auto& interface = config->interface[0].altsetting[0];
    std::uint8_t ports[8] = {};
    const int depth = libusb_get_port_numbers(all[i], ports, sizeof ports);
    std::string path(depth > 0 ? 0 : 1, '0');
    for (int k = 0; k < depth; ++k) path.append(k > 0 ? "." : "").append(std::to_string(ports[k]));
    unsigned char product[64] = "?";
    libusb_device_handle* handle = nullptr;
    if (libusb_open(all[i], &handle) == 0) {
      libusb_get_string_descriptor_ascii(handle, d.iProduct, product, sizeof product);
      libusb_close(handle);
    }
    std::printf("device %d-%s address %d id %04x:%04x class %02x endpoints %d speed %d product %s\n",
                libusb_get_bus_number(all[i]), path.c_str(), libusb_get_device_address(all[i]), d.idVendor,
                d.idProduct, interface.bInterfaceClass, interface.bNumEndpoints,
                libusb_get_device_speed(all[i]), reinterpret_cast<const char*>(product));
    libusb_free_config_descriptor(config);
  }
  libusb_free_device_list(all, 1);
}

void falcon(const Context& context, int packets) {
  const Handle device(context, 0x0403, 0xcb48);
  device.claim();
  load(device);
  std::printf("loaded 8192\n");
  int sent = 0;
  while ((exchange(device, 9) & 0x70) != 0x70 && sent < 5000) ++sent;
  std::printf("homed_after %d\n", sent);
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < packets; ++i) {
    if ((exchange(device, 3) & 0x70) != 0x70) throw std::runtime_error("no longer homed");
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  std::printf("round_trips_per_second %.0f\n", packets / took.count());
  checked(libusb_release_interface(device.usb, 0), "release");
}

/// Times packets there and back, of a Falcon that has its firmware.
void round_trips(const Context& context, int packets) {
  const Handle device(context, 0x0403, 0xcb48);
  device.claim();
  run_mode(device);
  std::vector<double> us;
  exchange(device, 3);
  const auto start = std::chrono::steady_clock::now();
  for (auto before = start; us.size() < static_cast<std::size_t>(packets);) {
    exchange(device, 3);
    const auto after = std::chrono::steady_clock::now();
    us.push_back(std::chrono::duration<double, std::micro>(after - before).count());
    before = after;
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  std::ranges::sort(us);
  std::printf("p50_us %.2f\np99_us %.2f\nround_trips_per_second %.0f\n", us[us.size() / 2],
              us[us.size() * 99 / 100], static_cast<double>(us.size()) / took.count());
  checked(libusb_release_interface(device.usb, 0), "release");
}

void mouse(const Context& context, std::uint16_t vendor, std::uint16_t product, int reports) {
  const Handle device(context, vendor, product);
  std::printf("kernel_driver %d\n", libusb_kernel_driver_active(device.usb, 0));
  device.claim();
  std::uint8_t led[] = {4, 1};
  checked(libusb_control_transfer(device.usb, 0x21, 9, 0x0204, 0, led, 2, kTimeout), "led");
  for (int i = 0; i < reports; ++i) {
    std::uint8_t report[64];
    int moved = 0;
    checked(libusb_interrupt_transfer(device.usb, kIn, report, sizeof report, &moved, kTimeout), "report");
    std::printf("report");
    for (int k = 0; k < moved; ++k) std::printf(" %02x", report[k]);
    std::printf("\n");
  }
  checked(libusb_release_interface(device.usb, 0), "release");
  std::printf("kernel_driver_after %d\n", libusb_kernel_driver_active(device.usb, 0));
}

}  // namespace

int main(int count, char** words) {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // who started this reads along
  const std::string what = count > 1 ? words[1] : "";
  try {
    const Context context;
    const int number = std::max(count > 2 ? std::atoi(words[2]) : 2000, 1);
    if (what == "list") {
      list(context);
    } else if (what == "falcon") {
      falcon(context, number);
    } else if (what == "round_trips") {
      round_trips(context, number);
    } else if (what == "hotplug") {
      hotplug(context);
    } else if (what == "timeouts") {
      timeouts(context);
    } else if (what == "storm") {
      storm(context, number);
    } else if (what == "mouse") {
      mouse(context, 0x046d, 0xc626, number);
    } else if (what == "mouse13") {
      mouse(context, 0x256f, 0xc62e, number);
    } else {
      std::fprintf(stderr,
                   "usage: usb_smoke list|falcon|round_trips|hotplug|timeouts|storm|mouse|mouse13 [N]\n");
      return 2;
    }
    return 0;
  } catch (const std::exception& error) {
    std::printf("error %s\n", error.what());
    return 1;
  }
}
