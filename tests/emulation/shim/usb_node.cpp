#include "tests/emulation/shim/usb_node.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/emulation/shim/real.h"

namespace palpate::emulation {

using wire::Frame;
using wire::Kind;

namespace {

constexpr std::uint8_t kIn = 0x80, kEndpointNumber = 0x0f;
constexpr int kSetupSize = 8, kFullSpeed = 2;
constexpr std::uint32_t kCapabilities =
    USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_NO_PACKET_SIZE_LIM | USBDEVFS_CAP_REAP_AFTER_DISCONNECT;

bool is_control(const usbdevfs_urb& urb) {
  return (urb.endpoint & kEndpointNumber) == 0;
}

/// The whole buffer of an OUT transfer, the setup alone of a control transfer that reads.
Frame submission(const usbdevfs_urb& urb, std::uint64_t id) {
  const auto* bytes = static_cast<const std::uint8_t*>(urb.buffer);
  const bool reads = ((is_control(urb) ? bytes[0] : urb.endpoint) & kIn) != 0;
  const int sent = !reads ? urb.buffer_length : is_control(urb) ? kSetupSize : 0;
  Frame frame;
  frame.header.kind = Kind::kSubmit;
  frame.header.endpoint = urb.endpoint;
  frame.header.size = static_cast<std::uint32_t>(urb.buffer_length);
  frame.header.id = id;
  frame.payload.assign(bytes, bytes + sent);
  return frame;
}

}  // namespace

std::shared_ptr<UsbNode> UsbNode::open(int bus, int address) {
  std::shared_ptr<UsbNode> node(new UsbNode);
  const int status = node->attach(bus, address);
  if (status == 0) return node;
  errno = status == -ENODEV ? ENOENT : -status;
  return nullptr;
}

int UsbNode::attach(int bus, int address) {
  link_ = wire::connect_to(emulator_socket());
  int ends[2];
  if (link_ < 0 || socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) return -ENODEV;
  poll_socket_ = ends[0];
  const int smallest = 1;  // the kernel takes its least: one message fills it
  setsockopt(poll_socket_, SOL_SOCKET, SO_SNDBUF, &smallest, sizeof smallest);
  Frame frame;
  frame.header.kind = Kind::kOpen;
  frame.header.bus = static_cast<std::uint8_t>(bus);
  frame.header.address = static_cast<std::uint8_t>(address);
  const bool sent = wire::send(link_, frame, ends[1]);
  close(ends[1]);
  if (!sent) return -ENODEV;
  while (replies_.empty() && !removed_) pump(true);
  if (replies_.empty()) return -ENODEV;
  const int status = replies_.front().header.status;
  replies_.clear();
  fill();
  return status;
}

UsbNode::~UsbNode() {
  if (link_ >= 0) close(link_);
  if (poll_socket_ >= 0) close(poll_socket_);
}

bool UsbNode::fill() const {
  static const char block[2048] = {};
  const ssize_t sent = ::send(poll_socket_, block, sizeof block, MSG_DONTWAIT | MSG_NOSIGNAL);
  return sent > 0 || errno == EAGAIN;  // it is full already
}

void UsbNode::leave() {
  removed_ = true;
  fill();
  if (link_ >= 0) close(link_);
  link_ = -1;
  // Whatever became of the emulator's end: from here on this number polls as a device that is gone.
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) return;
  ::send(ends[0], "", 1, MSG_NOSIGNAL);
  close(ends[1]);  // with that unread: POLLERR and POLLHUP
  dup3(ends[0], poll_socket_, O_CLOEXEC);
  close(ends[0]);
}

void UsbNode::pump(bool wait) {
  if (removed_) return;
  const bool open = reader_.fill(link_, wait);
  while (const auto frame = reader_.next()) {
    if (frame->header.kind == Kind::kComplete) {
      complete(*frame);
    } else {
      replies_.push_back(*frame);
    }
  }
  if (!open || reader_.broken()) leave();
}

void UsbNode::finish(std::uint64_t id, usbdevfs_urb* urb, int status) {
  urb->status = status;
  completed_.push_back(urb);
  pending_.erase(id);
}

void UsbNode::complete(const Frame& frame) {
  const auto found = pending_.find(frame.header.id);
  if (found == pending_.end()) return;
  usbdevfs_urb* urb = found->second;
  const int head = is_control(*urb) ? kSetupSize : 0;
  const int room = urb->buffer_length - head, got = static_cast<int>(frame.payload.size());
  if (got > 0)
    std::memcpy(static_cast<std::uint8_t*>(urb->buffer) + head, frame.payload.data(),
                static_cast<std::size_t>(std::min(room, got)));
  urb->actual_length = std::min(room, static_cast<int>(frame.header.size));
  finish(found->first, urb, frame.header.status);
}

int UsbNode::submit(usbdevfs_urb* urb) {
  pump(false);
  if (removed_) return -ENODEV;
  if (urb->type == USBDEVFS_URB_TYPE_ISO) return -EINVAL;
  if (is_control(*urb) && urb->buffer_length < kSetupSize) return -EINVAL;
  urb->actual_length = 0;
  pending_[++last_id_] = urb;
  if (wire::send(link_, submission(*urb, last_id_))) return 0;
  pending_.erase(last_id_);
  leave();
  return -ENODEV;
}

int UsbNode::discard(const usbdevfs_urb* urb) {
  pump(false);
  const auto found = std::ranges::find_if(pending_, [urb](const auto& p) { return p.second == urb; });
  if (found == pending_.end()) return -EINVAL;
  Frame frame;
  frame.header.kind = Kind::kDiscard;
  frame.header.id = found->first;
  if (!removed_) wire::send(link_, frame);
  return 0;
}

int UsbNode::reap(void** urb) {
  if (completed_.empty()) pump(false);
  if (completed_.empty() && !removed_) {
    if (!fill()) leave();  // an emulator that was killed
    pump(false);           // what came before the filling found nothing to empty
    Frame drain;
    drain.header.kind = Kind::kDrain;
    if (!completed_.empty() && !removed_) wire::send(link_, drain);
  }
  if (completed_.empty() && removed_ && !pending_.empty())
    finish(pending_.begin()->first, pending_.begin()->second, -ESHUTDOWN);
  if (completed_.empty()) return removed_ ? -ENODEV : -EAGAIN;
  *urb = completed_.front();
  completed_.pop_front();
  return 0;
}

int UsbNode::ask(Kind kind, int interface, wire::Bytes* answer) {
  Frame frame;
  frame.header.kind = kind;
  frame.header.status = interface;
  pump(false);
  if (removed_ || !wire::send(link_, frame)) return -ENODEV;
  while (replies_.empty() && !removed_) pump(true);
  if (replies_.empty()) return -ENODEV;
  const Frame reply = replies_.front();
  replies_.pop_front();
  if (answer != nullptr) *answer = reply.payload;
  return reply.header.status;
}

int UsbNode::get_driver(usbdevfs_getdriver* driver) {
  wire::Bytes name;
  const int status = ask(Kind::kGetDriver, static_cast<int>(driver->interface), &name);
  name.resize(std::min(name.size(), sizeof driver->driver - 1));
  std::memset(driver->driver, 0, sizeof driver->driver);
  std::ranges::copy(name, driver->driver);
  return status;
}

int UsbNode::driver_command(const usbdevfs_ioctl& command) {
  if (static_cast<unsigned>(command.ioctl_code) == USBDEVFS_DISCONNECT)
    return ask(Kind::kDetach, command.ifno);
  if (static_cast<unsigned>(command.ioctl_code) == USBDEVFS_CONNECT) return ask(Kind::kAttach, command.ifno);
  return -ENOTTY;
}

int UsbNode::ioctl(unsigned long request, void* argument) {
  const std::lock_guard lock(mutex_);
  switch (request) {
    case USBDEVFS_SUBMITURB:
      return submit(static_cast<usbdevfs_urb*>(argument));
    case USBDEVFS_REAPURBNDELAY:
      return reap(static_cast<void**>(argument));
    case USBDEVFS_DISCARDURB:
      return discard(static_cast<const usbdevfs_urb*>(argument));
    case USBDEVFS_CLAIMINTERFACE:
      return ask(Kind::kClaim, *static_cast<int*>(argument));
    case USBDEVFS_RELEASEINTERFACE:
      return ask(Kind::kRelease, *static_cast<int*>(argument));
    case USBDEVFS_GETDRIVER:
      return get_driver(static_cast<usbdevfs_getdriver*>(argument));
    case USBDEVFS_IOCTL:
      return driver_command(*static_cast<const usbdevfs_ioctl*>(argument));
    case USBDEVFS_DISCONNECT_CLAIM:
      return ask(Kind::kDetachAndClaim,
                 static_cast<int>(static_cast<const usbdevfs_disconnect_claim*>(argument)->interface));
    case USBDEVFS_GET_CAPABILITIES:
      *static_cast<std::uint32_t*>(argument) = kCapabilities;
      return 0;
    case USBDEVFS_GET_SPEED:
      return kFullSpeed;
    case USBDEVFS_SETCONFIGURATION:
    case USBDEVFS_SETINTERFACE:
    case USBDEVFS_CLEAR_HALT:
    case USBDEVFS_RESETEP:
    case USBDEVFS_RESET:
      return removed_ ? -ENODEV : 0;
    default:
      return -ENOTTY;
  }
}

}  // namespace palpate::emulation
