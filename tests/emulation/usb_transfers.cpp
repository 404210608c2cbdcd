// What a program's frames do to the bus: devices listed, opened, owned, and their transfers.
#include <algorithm>
#include <cerrno>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/emulation/usb_bus.h"

namespace palpate::emulation {

using wire::Frame;
using wire::Kind;

namespace {

constexpr std::uint8_t kIn = 0x80, kEndpointNumber = 0x0f;

Frame reply(int status, const std::string& text = {}) {
  Frame frame;
  frame.header.kind = Kind::kReply;
  frame.header.status = status;
  frame.payload.assign(text.begin(), text.end());
  return frame;
}

Frame plain(Kind kind) {
  Frame frame;
  frame.header.kind = kind;
  return frame;
}

}  // namespace

std::string driver_of(const Port& port) {
  if (port.claimed != nullptr) return "usbfs";
  return port.kernel_owns ? port.device->kernel_driver() : "";
}

wire::Frame description_of(const Port& port, wire::Kind kind) {
  Frame frame;
  frame.header.kind = kind;
  frame.header.bus = port.bus;
  frame.header.address = port.address;
  frame.payload.assign(port.name.begin(), port.name.end());
  frame.payload.push_back(0);
  const Bytes descriptors = port.device->descriptors();
  frame.payload.insert(frame.payload.end(), descriptors.begin(), descriptors.end());
  return frame;
}

Link::~Link() {
  close(fd);
  if (wake_socket >= 0) close(wake_socket);
}

void Link::wake() const {
  // More are never there at once. A program that fills the socket again has seen what was sent before; to
  // wait until it is empty would be to race with that program for ever.
  constexpr int kMost = 4;
  char byte = 0;
  for (int i = 0; i < kMost && recv(wake_socket, &byte, 1, MSG_DONTWAIT) > 0; ++i) {
  }
}

void Link::complete(std::uint64_t id, const UsbResult& result, std::size_t moved) const {
  Frame frame;
  frame.header.kind = Kind::kComplete;
  frame.header.id = id;
  frame.header.status = result.status;
  frame.header.size = static_cast<std::uint32_t>(moved);
  frame.payload = result.data;
  wire::send(fd, frame);
  wake();
}

bool UsbBus::handle(Link& link, const Frame& frame, double now) {
  switch (frame.header.kind) {
    case Kind::kList:
      list(link);
      return true;
    case Kind::kSubscribe:
      link.monitor = true;
      return wire::send(link.fd, plain(Kind::kEnd));
    case Kind::kOpen:
      open(link, frame.header, now);
      return true;
    case Kind::kDrain:
      link.wake();
      return true;
    case Kind::kSubmit:
      submit(link, frame, now);
      return true;
    case Kind::kDiscard:
      discard(link, frame.header.id);
      return true;
    case Kind::kClaim:
    case Kind::kRelease:
    case Kind::kGetDriver:
    case Kind::kDetach:
    case Kind::kAttach:
    case Kind::kDetachAndClaim:
      return wire::send(link.fd, ownership(link, frame));
    default:
      return false;
  }
}

void UsbBus::list(const Link& link) const {
  for (const auto& port : ports_) {
    if (port->plugged) wire::send(link.fd, description_of(*port, Kind::kDevice));
  }
  wire::send(link.fd, plain(Kind::kEnd));
}

void UsbBus::open(Link& link, const wire::Header& header, double now) {
  link.wake_socket = link.reader.take_descriptor();
  for (const auto& port : ports_) {
    if (!port->plugged || port->bus != header.bus || port->address != header.address) continue;
    if (port->device->denied()) {
      wire::send(link.fd, reply(-EACCES));
      return;
    }
    link.port = port.get();
    port->device->opened(now);
    wire::send(link.fd, reply(0));
    return;
  }
  wire::send(link.fd, reply(-ENODEV));
}

void UsbBus::submit(Link& link, const Frame& frame, double now) {
  if (link.port == nullptr) return;  // the shim learns of that by the end of the stream
  UsbDevice& device = *link.port->device;
  const wire::Header& header = frame.header;
  if ((header.endpoint & kEndpointNumber) == 0) {
    if (frame.payload.size() < 8) return link.complete(header.id, {-EINVAL, {}}, 0);
    const Bytes& p = frame.payload;
    const auto two = [&p](std::size_t i) { return static_cast<std::uint16_t>(p[i] | p[i + 1] << 8); };
    const UsbSetup setup{p[0], p[1], two(2), two(4), two(6)};
    const UsbResult result = device.control(setup, {p.begin() + 8, p.end()}, now);
    link.complete(header.id, result, setup.type & kIn ? result.data.size() : p.size() - 8);
  } else if (header.endpoint & kIn) {
    link.waiting.push_back({header.id, header.endpoint, header.size});
  } else {
    const int status = device.write(header.endpoint, frame.payload, now);
    link.complete(header.id, {status, {}}, status == 0 ? frame.payload.size() : 0);
  }
}

void UsbBus::discard(Link& link, std::uint64_t id) {
  const auto found = std::ranges::find_if(link.waiting, [id](const Link::Waiting& w) { return w.id == id; });
  if (found == link.waiting.end()) return;
  link.waiting.erase(found);
  link.complete(id, {-ENOENT, {}}, 0);
}

Frame UsbBus::ownership(Link& link, const Frame& frame) {
  if (link.port == nullptr) return reply(-ENODEV);
  Port& port = *link.port;
  const bool detaches = frame.header.kind == Kind::kDetach || frame.header.kind == Kind::kDetachAndClaim;
  const bool claims = frame.header.kind == Kind::kClaim || frame.header.kind == Kind::kDetachAndClaim;
  if (frame.header.status != port.device->interface()) return reply(-ENOENT);
  if (frame.header.kind == Kind::kGetDriver) {
    const std::string driver = driver_of(port);
    return reply(driver.empty() ? -ENODATA : 0, driver);
  }
  if (frame.header.kind == Kind::kRelease) {
    if (port.claimed != &link) return reply(-EINVAL);
    port.claimed = nullptr;
  } else if (frame.header.kind == Kind::kAttach) {
    if (port.claimed != nullptr) return reply(-EBUSY);
    if (port.device->kernel_driver().empty()) return reply(0);
    port.kernel_owns = true;
    return reply(1);
  }
  if (frame.header.kind == Kind::kDetach && !port.kernel_owns) return reply(-ENODATA);
  if (claims && (port.device->busy() || (port.claimed != nullptr && port.claimed != &link)))
    return reply(-EBUSY);
  if (detaches) port.kernel_owns = false;
  if (!claims) return reply(0);
  if (port.kernel_owns) return reply(-EBUSY);
  port.claimed = &link;
  return reply(0);
}

void UsbBus::serve(Link& link, double now) {
  for (std::size_t i = 0; link.port != nullptr && i < link.waiting.size();) {
    const Link::Waiting waiting = link.waiting[i];
    const auto result = link.port->device->read(waiting.endpoint, waiting.size, now);
    if (!result) {
      ++i;
      continue;
    }
    link.waiting.erase(link.waiting.begin() + static_cast<std::ptrdiff_t>(i));
    link.complete(waiting.id, *result, result->data.size());
  }
}

void UsbBus::serve(double now) {
  for (const auto& port : ports_) port->device->advance(now);
  for (Link* link : links) serve(*link, now);
}

double UsbBus::wake_at(double now) const {
  double wake = UsbDevice::kNever;
  for (const Link* link : links) {
    if (link->port != nullptr && !link->waiting.empty())
      wake = std::min(wake, link->port->device->wake_at(now));
  }
  return wake;
}

}  // namespace palpate::emulation
