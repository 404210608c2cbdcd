#pragma once
#include <deque>
#include <linux/usbdevice_fs.h>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "tests/emulation/wire.h"

namespace palpate::emulation {

/// An open file below /dev/bus/usb that is not one: its descriptor is a socket which polls as usbfs does
/// (POLLOUT: there is something to reap; POLLERR and POLLHUP: the device is gone), its ioctls go to the
/// emulator.
class UsbNode {
 public:
  /// Opens; null and errno as open(2) would.
  static std::shared_ptr<UsbNode> open(int bus, int address);
  ~UsbNode();
  UsbNode(const UsbNode&) = delete;
  UsbNode& operator=(const UsbNode&) = delete;

  /// What the program holds and polls; it is closed with this object, not by the program.
  int descriptor() const { return poll_socket_; }
  /// Zero or more, or a negative errno.
  int ioctl(unsigned long request, void* argument);

 private:
  UsbNode() = default;
  int attach(int bus, int address);
  int submit(usbdevfs_urb* urb);
  int discard(const usbdevfs_urb* urb);
  int reap(void** urb);
  int ask(wire::Kind kind, int interface, wire::Bytes* answer = nullptr);
  int get_driver(usbdevfs_getdriver* driver);
  int driver_command(const usbdevfs_ioctl& command);
  void pump(bool wait);
  void complete(const wire::Frame& frame);
  void finish(std::uint64_t id, usbdevfs_urb* urb, int status);
  bool fill() const;
  void leave();

  std::mutex mutex_;
  int poll_socket_ = -1, link_ = -1;
  bool removed_ = false;
  wire::FrameReader reader_;
  std::uint64_t last_id_ = 0;
  std::map<std::uint64_t, usbdevfs_urb*> pending_;
  std::deque<usbdevfs_urb*> completed_;
  std::deque<wire::Frame> replies_;
};

}  // namespace palpate::emulation
