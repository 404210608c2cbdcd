#pragma once
/// Frames between the shim (in the program under test) and the emulator, over a unix stream socket: a header
/// of 24 bytes in the machine's own order, and `length` bytes after it. Three sorts of connection, told apart
/// by the first frame of the shim:
///
/// - kList: the emulator sends a kDevice for every device that is plugged in, then kEnd.
/// - kSubscribe: kEnd at once; from then on kAttached and kDetached as they happen.
/// - kOpen (bus, address; with it the file descriptor of a wake socket): kReply with 0 or -EACCES, -ENODEV.
/// Then
///   kSubmit (id, endpoint, `size` bytes of room for IN; setup and data as payload) until its kComplete (id,
///   status, `size` bytes moved; payload for IN); kDiscard (id); and kClaim, kRelease, kGetDriver, kDetach,
///   kAttach, kDetachAndClaim (`status`: the interface), each answered by one kReply.
///
/// The wake socket is one end of a SEQPACKET pair; the other is what the program polls. The shim fills its
/// end when nothing is left to reap; the emulator empties it with every kComplete (or when kDrain asks), so
/// that the program's poll says POLLOUT exactly when there is something to reap. When the device goes, the
/// emulator ends its side of the connection; the shim fills the wake socket once more and ends its own; the
/// emulator closes the wake socket with that unread, and the program's poll says POLLERR and POLLHUP.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace palpate::emulation::wire {

using Bytes = std::vector<std::uint8_t>;

enum class Kind : std::uint8_t {
  kList = 1,
  kDevice,
  kEnd,
  kSubscribe,
  kAttached,
  kDetached,
  kOpen,
  kReply,
  kSubmit,
  kComplete,
  kDiscard,
  kDrain,
  kClaim,
  kRelease,
  kGetDriver,
  kDetach,
  kAttach,
  kDetachAndClaim,
};

struct Header {
  std::uint32_t length = 0;  ///< bytes of payload
  Kind kind = Kind::kEnd;
  std::uint8_t endpoint = 0, bus = 0, address = 0;
  std::int32_t status = 0;  ///< 0 or a negative errno; or the number of an interface
  std::uint32_t size = 0;   ///< bytes
  std::uint64_t id = 0;     ///< of a transfer
};
static_assert(sizeof(Header) == 24);

struct Frame {
  Header header;
  Bytes payload;
};
constexpr std::uint32_t kLargestPayload = 1 << 20;  ///< bytes; more is no frame

/// A frame as it stands on the wire; its `length` is set from the payload.
Bytes encode(const Frame& frame);
/// Sends a frame, waiting for room if need be; with it a file descriptor unless that is -1. False: the other
/// side is gone.
bool send(int fd, const Frame& frame, int descriptor = -1);

/// Cuts what a stream socket brings into frames.
class FrameReader {
 public:
  ~FrameReader();
  /// Reads what is there. False: the other side has ended, or what it sent is no frame.
  bool fill(int fd, bool wait);
  void feed(const std::uint8_t* data, std::size_t size) { bytes_.insert(bytes_.end(), data, data + size); }
  std::optional<Frame> next();
  bool broken() const { return broken_; }
  /// A file descriptor that came with the frames, once; -1: none.
  int take_descriptor();

 private:
  Bytes bytes_;
  std::size_t start_ = 0;  // of what is not yet cut
  int descriptor_ = -1;
  bool broken_ = false;
};

/// Connects to the unix socket at `path`; -1 and errno if nobody listens there.
int connect_to(const std::string& path);

}  // namespace palpate::emulation::wire
