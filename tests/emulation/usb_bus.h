#pragma once
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tests/emulation/usb_device.h"
#include "tests/emulation/wire.h"

namespace palpate::emulation {

struct Port;

/// A program's connection, see wire.h.
struct Link {
  explicit Link(int socket) : fd(socket) {}
  ~Link();
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  /// Tells the program that there is something to reap.
  void wake() const;
  void complete(std::uint64_t id, const UsbResult& result, std::size_t moved) const;

  struct Waiting {  // an IN transfer without data so far
    std::uint64_t id;
    std::uint8_t endpoint;
    std::size_t size;  // bytes
  };
  int fd;
  int wake_socket = -1;
  wire::FrameReader reader;
  bool monitor = false;
  Port* port = nullptr;  // of an opened device; null again when that has gone
  std::deque<Waiting> waiting;
};

/// A port with the device that is, or was, plugged into it.
struct Port {
  std::string name;  // as in sysfs, "2-1" or "2-1.4"
  std::uint8_t bus = 1, address = 0;
  bool plugged = true;
  std::unique_ptr<UsbDevice> device;
  bool kernel_owns = false;       // the kernel's driver is bound to the interface
  const Link* claimed = nullptr;  // by this program
};

/// Who holds the interface: "usbfs", the kernel's driver, or nobody.
std::string driver_of(const Port& port);

/// A kDevice, kAttached or kDetached.
wire::Frame description_of(const Port& port, wire::Kind kind);

/// The devices, and what programs do to them over their links. Times: seconds of the wall clock since the
/// start.
class UsbBus {
 public:
  /// `name` as in sysfs: bus, '-', ports joined by '.'; hubs above it come by themselves. Throws
  /// `CommandError` if it is no such name, or is taken.
  void add(const std::string& name, std::unique_ptr<UsbDevice> device);
  /// One frame of a program. False: the link is to be closed.
  bool handle(Link& link, const wire::Frame& frame, double now);
  /// Ends what waits for data, as far as there is some; lets time pass for all devices.
  void serve(double now);
  /// When `serve` is worth another call.
  double wake_at(double now) const;

  void closed(const Link& link);
  /// A line of the control socket; returns the answer without its end of line.
  std::string command(const std::string& line, double now);

  std::vector<Link*> links;  ///< all that are open; who owns them keeps this

 private:
  void put(const std::string& name, std::uint8_t bus, std::unique_ptr<UsbDevice> device);
  bool has(const std::string& name) const;
  void list(const Link& link) const;
  void open(Link& link, const wire::Header& header, double now);
  void submit(Link& link, const wire::Frame& frame, double now);
  void discard(Link& link, std::uint64_t id);
  wire::Frame ownership(Link& link, const wire::Frame& frame);
  void serve(Link& link, double now);
  void plug(Port& port, double now);
  void unplug(Port& port);
  void announce(const Port& port, wire::Kind kind) const;
  Port& find(const std::string& name);

  std::vector<std::unique_ptr<Port>> ports_;
  std::map<std::uint8_t, std::uint8_t> last_address_;  // by bus
};

}  // namespace palpate::emulation
