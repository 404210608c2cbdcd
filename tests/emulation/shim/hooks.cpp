// The libc calls through which libusb reaches a device: open and its kin for the nodes and for sysfs, ioctl,
// close, and statfs. With USBSHIM set, what lies below /dev/bus/usb and /sys/bus/usb/devices comes from the
// emulator alone: a device that is really plugged in is neither seen nor touched. Without it every call goes
// on as it came.
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/vfs.h>
#include <unistd.h>

#include "tests/emulation/shim/device_list.h"
#include "tests/emulation/shim/real.h"
#include "tests/emulation/shim/usb_node.h"

#define EXPORTED extern "C" __attribute__((visibility("default")))

using namespace palpate::emulation;

namespace {

/// The open nodes, by descriptor. Never destroyed: programs close descriptors while they end.
struct Nodes {
  std::mutex mutex;
  std::map<int, std::shared_ptr<UsbNode>> by_descriptor;
  std::atomic<int> count{0};
};
Nodes& nodes() {
  static Nodes& all = *new Nodes;
  return all;
}

std::shared_ptr<UsbNode> find(int fd) {
  Nodes& all = nodes();
  if (all.count == 0) return nullptr;
  const std::lock_guard lock(all.mutex);
  const auto found = all.by_descriptor.find(fd);
  return found == all.by_descriptor.end() ? nullptr : found->second;
}

std::shared_ptr<UsbNode> take(int fd) {
  Nodes& all = nodes();
  if (all.count == 0) return nullptr;
  const std::lock_guard lock(all.mutex);
  const auto found = all.by_descriptor.find(fd);
  if (found == all.by_descriptor.end()) return nullptr;
  auto node = found->second;
  all.by_descriptor.erase(found);
  --all.count;
  return node;
}

int open_node(const char* path) {
  int bus = 0, address = 0;
  if (std::sscanf(path, "%d/%d", &bus, &address) != 2) return errno = ENOENT, -1;
  const auto node = UsbNode::open(bus, address);
  if (!node) return -1;
  Nodes& all = nodes();
  const std::lock_guard lock(all.mutex);
  all.by_descriptor[node->descriptor()] = node;
  ++all.count;
  return node->descriptor();
}

int open_attribute(const std::string& path) {
  const std::size_t slash = path.find('/');
  if (slash == std::string::npos) return errno = ENOENT, -1;
  const auto text = sysfs_attribute(path.substr(0, slash), path.substr(slash + 1));
  if (!text) return errno = ENOENT, -1;
  const int fd = memfd_create("sysfs", MFD_CLOEXEC);
  if (fd < 0 || write(fd, text->data(), text->size()) != static_cast<ssize_t>(text->size())) return -1;
  lseek(fd, 0, SEEK_SET);
  return fd;
}

/// True if the path is the emulator's business; `fd` is then what open returns.
bool emulated(const char* path, int& fd) {
  static constexpr char kNodes[] = "/dev/bus/usb/", kSysfs[] = "/sys/bus/usb/devices/";
  if (path == nullptr || path[0] != '/' || !active()) return false;
  if (std::strncmp(path, kNodes, sizeof kNodes - 1) == 0) {
    fd = open_node(path + sizeof kNodes - 1);
    return true;
  }
  if (std::strncmp(path, kSysfs, sizeof kSysfs - 1) != 0) return false;
  fd = open_attribute(path + sizeof kSysfs - 1);
  return true;
}

mode_t mode_of(int flags, va_list& rest) {
  return (flags & (O_CREAT | O_TMPFILE)) != 0 ? static_cast<mode_t>(va_arg(rest, unsigned)) : 0;
}

int open_by(const char* name, const char* path, int flags, mode_t mode) {
  int fd = -1;
  if (emulated(path, fd)) return fd;
  return real<int (*)(const char*, int, ...)>(name)(path, flags, mode);
}

int openat_by(const char* name, int folder, const char* path, int flags, mode_t mode) {
  int fd = -1;
  if (emulated(path, fd)) return fd;
  return real<int (*)(int, const char*, int, ...)>(name)(folder, path, flags, mode);
}

}  // namespace

EXPORTED int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  return open_by("open", path, flags, mode);
}
EXPORTED int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  return open_by("open64", path, flags, mode);
}
EXPORTED int openat(int folder, const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  return openat_by("openat", folder, path, flags, mode);
}
EXPORTED int openat64(int folder, const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  return openat_by("openat64", folder, path, flags, mode);
}
// What open becomes when a program is compiled with _FORTIFY_SOURCE.
EXPORTED int __open_2(const char* path, int flags) {
  return open_by("open", path, flags, 0);
}
EXPORTED int __open64_2(const char* path, int flags) {
  return open_by("open64", path, flags, 0);
}

EXPORTED int close(int fd) {
  static const auto next = real<int (*)(int)>("close");
  if (take(fd)) return 0;  // the node closes its descriptors as it goes
  return next(fd);
}

EXPORTED int ioctl(int fd, unsigned long request, ...) noexcept {
  static const auto next = real<int (*)(int, unsigned long, ...)>("ioctl");
  va_list rest;
  va_start(rest, request);
  void* argument = va_arg(rest, void*);
  va_end(rest);
  const auto node = find(fd);
  if (!node) return next(fd, request, argument);
  const int result = node->ioctl(request, argument);
  if (result >= 0) return result;
  errno = -result;
  return -1;
}

EXPORTED int statfs(const char* path, struct statfs* filesystem) noexcept {
  constexpr long kSysfsMagic = 0x62656572;
  static const auto next = real<int (*)(const char*, struct statfs*)>("statfs");
  const int result = next(path, filesystem);
  if (!active() || (std::strcmp(path, "/sys") != 0 && std::strcmp(path, "/sys/") != 0)) return result;
  filesystem->f_type = kSysfsMagic;  // mounted or not: what libusb reads below it comes from here
  return 0;
}
