#pragma once
/// Who talks to whom: the two ends of a session as pure state machines (protocol/STATES.md). Time is an
/// argument.
#include <array>
#include <compare>
#include <optional>
#include <vector>

#include "common/ages.h"
#include "protocol/codec.h"
#include "protocol/replay_window.h"

namespace palpate::protocol {

/// An IP address and port, in network order of bytes.
struct Endpoint {
  std::array<std::uint8_t, 16> address{};  ///< IPv4 in the first four
  std::uint16_t port = 0;
  bool v6 = false;
  auto operator<=>(const Endpoint&) const = default;
};

/// The client's end. Asks until welcomed; asks again, without giving up what it has, when the server falls
/// silent.
class ClientSession {
 public:
  /// `nonce`: drawn once per run of the program.
  explicit ClientSession(std::uint64_t nonce) : nonce_(nonce) {}

  /// A Hello to send now, if one is due. Call often (every 50 ms will do).
  std::optional<Hello> poll(Time now) noexcept;

  /// A decoded datagram came. Returns its message if that is a force sample of this session and the newest so
  /// far, or a page of the surface for it; everything else is taken care of here. `stats` gets what was
  /// received, lost, doubled or rejected.
  const Message* receive(const Datagram& datagram, Time now, LinkStats& stats) noexcept;

  /// Header of the next datagram to send in this session.
  Header next_header() noexcept { return {current_.session, ++current_.sent}; }

  bool welcomed() const noexcept { return current_.session != 0; }
  const Welcome& welcome() const noexcept { return welcome_; }
  /// Why the server last said no, until it says yes.
  std::optional<RefuseReason> refused() const noexcept { return refused_; }

  static constexpr Time kHelloPeriod = std::chrono::milliseconds(250);
  static constexpr Time kSilence = kOutage;             ///< without a sample: ask again
  static constexpr std::uint64_t kFarthestSample = 24;  ///< datagrams ahead: 0.8 s at 30 steps a second

 private:
  bool heard_lately(Time now) const noexcept { return last_heard_ && now - *last_heard_ < kSilence; }

  /// Numbers go on where they were should a session that was left come back.
  struct Numbered {
    std::uint64_t session = 0, sent = 0;
    NewestOnly samples{};
    ReplayWindow window{kFarthestSample};
  };
  Numbered current_, left_;
  std::uint64_t nonce_;
  Welcome welcome_;
  std::optional<RefuseReason> refused_;
  std::optional<Time> last_hello_, last_heard_;
};

/// The server's end: who holds which tool. A client program holds one tool per session; sessions from one
/// address differ in their nonces.
class ServerSessions {
 public:
  static constexpr std::uint64_t kFarthestState = 100;  ///< datagrams ahead: 1 s of the slowest client
  struct Member {
    std::uint64_t session = 0, nonce = 0, sent = 0;
    Endpoint endpoint{};
    std::uint8_t tool = 0;
    Time last_heard{};
    ReplayWindow window{kFarthestState};
    NewestOnly ticks{};
  };
  /// What came of a datagram: an answer to send back, or a tool state newer than all before.
  struct Outcome {
    std::optional<std::pair<Header, Message>> answer{};
    const ToolState* tool_state = nullptr;
    const Member* left = nullptr;  ///< said Bye; valid until the next call
  };

  /// `tool_radii`: of each tool of the scene, m.
  ServerSessions(double rate_hz, std::vector<double> tool_radii)
      : rate_hz_(rate_hz), radii_(std::move(tool_radii)) {}

  /// A decoded datagram came. `fresh_id`: a random number, used if this opens a session.
  Outcome receive(const Datagram& datagram, const Endpoint& from, Time now, std::uint64_t fresh_id,
                  LinkStats& stats);

  /// Drops and returns members not heard for `kTimeout`.
  std::vector<Member> expire(Time now);

  /// Who holds `tool`; null when nobody does.
  Member* holder(std::uint8_t tool) noexcept;
  const std::vector<Member>& members() const noexcept { return members_; }

  static constexpr Time kTimeout = std::chrono::milliseconds(800);

 private:
  Outcome admit(const Hello& hello, const Endpoint& from, Time now, std::uint64_t fresh_id, LinkStats& stats);
  std::optional<std::uint8_t> free_tool() noexcept;

  double rate_hz_;
  std::vector<double> radii_;
  std::vector<Member> members_;
  Member left_;
};

}  // namespace palpate::protocol
