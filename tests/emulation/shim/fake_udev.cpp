// The libudev calls that libusb makes, answered from the emulator's list of devices. Without USBSHIM they go
// to the real library. Only the calls of libusb are here: a program that uses libudev itself sees a mixture.
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <list>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/emulation/shim/device_list.h"
#include "tests/emulation/shim/real.h"

#define EXPORTED extern "C" __attribute__((visibility("default")))
// Without an emulator: what the real library says.
#define PASS_ON(name, ...) \
  if (!active()) return real<decltype(&name)>(#name)(__VA_ARGS__)

using namespace palpate::emulation;

struct udev {};
struct udev_device {
  DeviceEntry entry;
  std::string node, action;
};
struct udev_list_entry {
  std::string path;
  udev_list_entry* next = nullptr;
};
struct udev_enumerate {
  std::list<udev_list_entry> entries;
};
struct udev_monitor {
  int fd = -1;
};

namespace {

const std::string kDevices = "/sys/bus/usb/devices/";
udev the_udev;

udev_device* new_device(const DeviceEntry& entry, const char* action) {
  return new udev_device{entry, entry.node(), action};
}

/// Exactly one frame, so that what waits behind it is still seen by poll.
bool receive_one(int fd, wire::FrameReader& reader) {
  std::uint8_t bytes[4096];
  const ssize_t there = recv(fd, bytes, sizeof bytes, MSG_PEEK | MSG_DONTWAIT);
  wire::Header header;
  if (there < static_cast<ssize_t>(sizeof header)) return there < 0 && (errno == EAGAIN || errno == EINTR);
  std::memcpy(&header, bytes, sizeof header);
  const std::size_t size = sizeof header + header.length;
  if (size > sizeof bytes) return false;
  if (static_cast<std::size_t>(there) < size) return true;
  if (recv(fd, bytes, size, 0) != static_cast<ssize_t>(size)) return false;
  reader.feed(bytes, size);
  return true;
}

/// The emulator has ended: a descriptor that is never readable again, under the same number.
void silence(int fd) {
  const int quiet = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  dup3(quiet, fd, O_CLOEXEC);
  close(quiet);
}

}  // namespace

EXPORTED udev* udev_new() {
  PASS_ON(udev_new);
  return &the_udev;
}
EXPORTED udev* udev_unref(udev* u) {
  PASS_ON(udev_unref, u);
  return nullptr;
}

EXPORTED udev_monitor* udev_monitor_new_from_netlink(udev* u, const char* name) {
  PASS_ON(udev_monitor_new_from_netlink, u, name);
  const int fd = wire::connect_to(emulator_socket());
  wire::Frame ask;
  ask.header.kind = wire::Kind::kSubscribe;
  wire::Header answer;
  if (fd >= 0 && wire::send(fd, ask) && recv(fd, &answer, sizeof answer, MSG_WAITALL) == sizeof answer)
    return new udev_monitor{fd};
  std::fprintf(stderr, "libusb_vhci_shim: nobody serves %s\n", emulator_socket().c_str());
  if (fd >= 0) close(fd);
  return nullptr;
}
EXPORTED int udev_monitor_filter_add_match_subsystem_devtype(udev_monitor* m, const char* s, const char* t) {
  PASS_ON(udev_monitor_filter_add_match_subsystem_devtype, m, s, t);
  return 0;
}
EXPORTED int udev_monitor_enable_receiving(udev_monitor* m) {
  PASS_ON(udev_monitor_enable_receiving, m);
  return 0;
}
EXPORTED int udev_monitor_get_fd(udev_monitor* m) {
  PASS_ON(udev_monitor_get_fd, m);
  return m->fd;
}
EXPORTED udev_device* udev_monitor_receive_device(udev_monitor* m) {
  PASS_ON(udev_monitor_receive_device, m);
  wire::FrameReader reader;
  if (!receive_one(m->fd, reader)) silence(m->fd);
  const auto frame = reader.next();
  if (!frame) return nullptr;
  return new_device(device_entry(*frame), frame->header.kind == wire::Kind::kAttached ? "add" : "remove");
}
EXPORTED udev_monitor* udev_monitor_unref(udev_monitor* m) {
  PASS_ON(udev_monitor_unref, m);
  close(m->fd);
  delete m;
  return nullptr;
}

EXPORTED udev_enumerate* udev_enumerate_new(udev* u) {
  PASS_ON(udev_enumerate_new, u);
  return new udev_enumerate;
}
EXPORTED int udev_enumerate_add_match_subsystem(udev_enumerate* e, const char* subsystem) {
  PASS_ON(udev_enumerate_add_match_subsystem, e, subsystem);
  return 0;
}
EXPORTED int udev_enumerate_add_match_property(udev_enumerate* e, const char* property, const char* value) {
  PASS_ON(udev_enumerate_add_match_property, e, property, value);
  return 0;
}
EXPORTED int udev_enumerate_scan_devices(udev_enumerate* e) {
  PASS_ON(udev_enumerate_scan_devices, e);
  for (const DeviceEntry& device : list_devices()) {
    udev_list_entry* before = e->entries.empty() ? nullptr : &e->entries.back();
    e->entries.push_back({kDevices + device.name});
    if (before != nullptr) before->next = &e->entries.back();
  }
  return 0;
}
EXPORTED udev_list_entry* udev_enumerate_get_list_entry(udev_enumerate* e) {
  PASS_ON(udev_enumerate_get_list_entry, e);
  return e->entries.empty() ? nullptr : &e->entries.front();
}
EXPORTED udev_enumerate* udev_enumerate_unref(udev_enumerate* e) {
  PASS_ON(udev_enumerate_unref, e);
  delete e;
  return nullptr;
}
EXPORTED udev_list_entry* udev_list_entry_get_next(udev_list_entry* entry) {
  PASS_ON(udev_list_entry_get_next, entry);
  return entry->next;
}
EXPORTED const char* udev_list_entry_get_name(udev_list_entry* entry) {
  PASS_ON(udev_list_entry_get_name, entry);
  return entry->path.c_str();
}

EXPORTED udev_device* udev_device_new_from_syspath(udev* u, const char* path) {
  PASS_ON(udev_device_new_from_syspath, u, path);
  for (const DeviceEntry& device : list_devices()) {
    if (kDevices + device.name == path) return new_device(device, "");
  }
  return new_device({}, "");  // gone since the scan; libusb does not look for a null pointer
}
EXPORTED const char* udev_device_get_devnode(udev_device* d) {
  PASS_ON(udev_device_get_devnode, d);
  return d->entry.name.empty() ? nullptr : d->node.c_str();
}
EXPORTED const char* udev_device_get_sysname(udev_device* d) {
  PASS_ON(udev_device_get_sysname, d);
  return d->entry.name.c_str();
}
EXPORTED const char* udev_device_get_action(udev_device* d) {
  PASS_ON(udev_device_get_action, d);
  return d->action.empty() ? nullptr : d->action.c_str();
}
EXPORTED udev_device* udev_device_unref(udev_device* d) {
  PASS_ON(udev_device_unref, d);
  delete d;
  return nullptr;
}
