#include "tests/emulation/wire.h"

#include <cerrno>
#include <cstring>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace palpate::emulation::wire {
namespace {

/// Room for one file descriptor beside a message.
union Ancillary {
  cmsghdr header;
  char bytes[CMSG_SPACE(sizeof(int))];
};

void attach(msghdr& message, Ancillary& ancillary, int descriptor) {
  std::memset(&ancillary, 0, sizeof ancillary);
  message.msg_control = ancillary.bytes;
  message.msg_controllen = sizeof ancillary.bytes;
  cmsghdr* header = CMSG_FIRSTHDR(&message);
  header->cmsg_level = SOL_SOCKET;
  header->cmsg_type = SCM_RIGHTS;
  header->cmsg_len = CMSG_LEN(sizeof(int));
  std::memcpy(CMSG_DATA(header), &descriptor, sizeof(int));
}

}  // namespace

Bytes encode(const Frame& frame) {
  Header header = frame.header;
  header.length = static_cast<std::uint32_t>(frame.payload.size());
  Bytes bytes(sizeof header + frame.payload.size());
  std::memcpy(bytes.data(), &header, sizeof header);
  if (!frame.payload.empty())
    std::memcpy(bytes.data() + sizeof header, frame.payload.data(), frame.payload.size());
  return bytes;
}

bool send(int fd, const Frame& frame, int descriptor) {
  Bytes bytes = encode(frame);
  for (std::size_t sent = 0; sent < bytes.size();) {
    iovec piece{bytes.data() + sent, bytes.size() - sent};
    msghdr message{};
    message.msg_iov = &piece;
    message.msg_iovlen = 1;
    Ancillary ancillary;
    if (descriptor >= 0 && sent == 0) attach(message, ancillary, descriptor);
    const ssize_t done = sendmsg(fd, &message, MSG_NOSIGNAL);
    if (done > 0) {
      sent += static_cast<std::size_t>(done);
    } else if (errno == EAGAIN) {
      pollfd room{fd, POLLOUT, 0};
      poll(&room, 1, -1);
    } else if (errno != EINTR) {
      return false;
    }
  }
  return true;
}

FrameReader::~FrameReader() {
  if (descriptor_ >= 0) close(descriptor_);
}

bool FrameReader::fill(int fd, bool wait) {
  std::uint8_t buffer[16384];
  iovec piece{buffer, sizeof buffer};
  msghdr message{};
  Ancillary ancillary;
  message.msg_iov = &piece;
  message.msg_iovlen = 1;
  message.msg_control = ancillary.bytes;
  message.msg_controllen = sizeof ancillary.bytes;
  ssize_t got = 0;
  do {
    got = recvmsg(fd, &message, MSG_CMSG_CLOEXEC | (wait ? 0 : MSG_DONTWAIT));
  } while (got < 0 && errno == EINTR);
  if (got < 0) return errno == EAGAIN;
  if (got == 0 || broken_) return false;
  feed(buffer, static_cast<std::size_t>(got));
  const cmsghdr* header = CMSG_FIRSTHDR(&message);
  if (header != nullptr && header->cmsg_type == SCM_RIGHTS) {
    if (descriptor_ >= 0) close(descriptor_);
    std::memcpy(&descriptor_, CMSG_DATA(header), sizeof(int));
  }
  return true;
}

std::optional<Frame> FrameReader::next() {
  const std::size_t size = bytes_.size() - start_;
  Frame frame;
  if (broken_ || size < sizeof frame.header) return std::nullopt;
  std::memcpy(&frame.header, bytes_.data() + start_, sizeof frame.header);
  const auto kind = static_cast<std::uint8_t>(frame.header.kind);
  broken_ = frame.header.length > kLargestPayload || kind < static_cast<std::uint8_t>(Kind::kList) ||
            kind > static_cast<std::uint8_t>(Kind::kDetachAndClaim);
  if (broken_ || size < sizeof frame.header + frame.header.length) return std::nullopt;
  const auto payload = bytes_.begin() + static_cast<std::ptrdiff_t>(start_ + sizeof frame.header);
  frame.payload.assign(payload, payload + frame.header.length);
  start_ += sizeof frame.header + frame.header.length;
  if (start_ == bytes_.size()) {
    bytes_.clear();
    start_ = 0;
  }
  return frame;
}

int FrameReader::take_descriptor() {
  const int taken = descriptor_;
  descriptor_ = -1;
  return taken;
}

int connect_to(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) {
    errno = ENAMETOOLONG;
    return -1;
  }
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return -1;
  if (connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return fd;
  const int why = errno;
  close(fd);
  errno = why;
  return -1;
}

}  // namespace palpate::emulation::wire
