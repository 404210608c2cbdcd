#pragma once
/// Who talks to whom: the two ends of a session as pure state machines (protocol/STATES.md). Time is an
/// argument.
#include <optional>
#include <span>
#include <vector>

#include "common/ages.h"
#include "protocol/auth.h"
#include "protocol/replay_window.h"

namespace palpate::protocol {

/// The keys of both directions, as one end needs them; none: nothing is authenticated.
struct SessionKeys {
  Key in, out;
};

/// Why a Hello, or an answer to one, is not of who has our key. For messages to people alone: anybody may
/// have sent it.
enum class KeyMismatch {
  kNoTag,        ///< it was sent without a key
  kOtherKey,     ///< of another key: another number, or other bytes
  kNotExpected,  ///< it has a tag, and we have no key
};

/// The client's end. Asks until welcomed; asks again, without giving up what it has, when the server falls
/// silent. With a key it obeys nothing without the tag of that key.
class ClientSession {
 public:
  /// `nonce`: drawn once per run of the program. `shared`: the key of both ends, or none.
  explicit ClientSession(const Nonce& nonce, const Key& shared = {})
      : nonce_(nonce), shared_(shared), hello_keys_(keys_for({})) {}

  /// A Hello to send now, if one is due. Call often (every 50 ms will do), and after each datagram that came.
  std::optional<Hello> poll(Time now) noexcept;

  /// A datagram that `decode_fields` accepted came. Returns its message if that is a force sample of this
  /// session and the newest so far, a page of the surface, or a pointer for it; everything else is taken care
  /// of here. `stats` gets what was received, lost, doubled or rejected.
  const Message* receive(const Datagram& datagram, Time now, LinkStats& stats) noexcept;

  /// Header of the next datagram to send in this session.
  Header next_header() noexcept { return {current_.session, ++current_.sent}; }
  /// Writes a message as the next datagram to send, with its header and tag; returns its size. `out` holds
  /// `kMaxDatagram` bytes.
  std::size_t write(const Message& message, std::span<std::byte> out) noexcept;

  /// Writes ticks, oldest first, as the next datagram (`encode_ticks`); returns its size, or 0 where they do
  /// not fit.
  std::size_t write_ticks(std::span<const ToolState> ticks, std::span<std::byte> out) noexcept;

  bool welcomed() const noexcept { return current_.session != 0; }
  /// Returns the number of the session; it changes after a restart of the server. 0: none yet.
  std::uint64_t number() const noexcept { return current_.session; }
  const Welcome& welcome() const noexcept { return welcome_; }
  /// Why the server last said no, until it says yes.
  std::optional<RefuseReason> refused() const noexcept { return refused_; }

  /// Why the newest answer to a Hello was not obeyed, until a Welcome is.
  std::optional<KeyMismatch> mismatch() const noexcept { return mismatch_; }

  static constexpr Time kHelloPeriod = std::chrono::milliseconds(250);  ///< what a lost Hello costs
  static constexpr std::uint64_t kAnswered = 4;    ///< of the newest Hellos: an answer takes a second at most
  static constexpr Time kSilence = kOutage;        ///< without a sample: ask again
  static constexpr std::uint64_t kMaxSample = 24;  ///< datagrams ahead: 0.8 s at 30 steps a second

 private:
  bool is_proven(const Datagram& datagram, LinkStats& stats) noexcept;
  bool heard_lately(Time now) const noexcept { return last_heard_ && now - *last_heard_ < kSilence; }

  /// Numbers go on where they were should a session that was left come back.
  struct Numbered {
    std::uint64_t session = 0, sent = 0;
    SessionKeys keys{};
    NewestOnly samples{};
    ReplayWindow window{kMaxSample};
  };
  SessionKeys keys_for(const Nonce& server) const noexcept;
  bool answers_lately(const Nonce& nonce, std::uint64_t attempt) const noexcept;
  void challenged(const Challenge& challenge, LinkStats& stats) noexcept;
  void welcomed_by(const Datagram& datagram, const Welcome& welcome, Time now, LinkStats& stats) noexcept;
  void refused_by(const Datagram& datagram, const Refuse& refuse, LinkStats& stats) noexcept;

  Numbered current_, departed_;
  Nonce nonce_;
  Cookie cookie_{};
  std::uint64_t attempts_ = 0, welcomed_attempt_ = 0;  // Hellos said, and that which the session answers
  Key shared_;
  SessionKeys hello_keys_;
  bool prompted_ = false;                   // a Challenge came that is to be answered at once
  std::optional<Time> prompted_in_period_;  // `last_hello_` when one last was
  Welcome welcome_;
  std::optional<RefuseReason> refused_;
  std::optional<KeyMismatch> mismatch_;
  std::optional<Time> last_hello_, last_heard_;
};

/// The server's end: who holds which tool. A client program holds one tool per session; sessions from one
/// address differ in their nonces. Nobody is remembered before he has said a cookie back, and nobody keeps a
/// tool who sends no tool states. With keys nothing is obeyed without a tag, and a session goes on where its
/// client's address changes.
class ServerSessions {
 public:
  static constexpr std::uint64_t kMaxState = 100;  ///< datagrams ahead: 1 s of the slowest client
  struct Member {
    std::uint64_t session = 0, sent = 0;
    std::uint8_t key = 0;  ///< the number of the one that it joined with; 0: none
    Nonce nonce{}, server_nonce{};
    std::uint64_t attempt = 0;  ///< of the newest Hello that had a valid cookie
    Endpoint endpoint{};        ///< where answers go
    Endpoint reached{};         ///< that which last proved to receive what is sent there
    std::uint64_t probe = 0;  ///< number of the first sample sent to `endpoint` since it became that; 0: none
    std::uint64_t newest_sent = 0;  ///< number of the newest sample sent to the client
    std::uint8_t tool = 0;
    Time last_heard{};  ///< a tool state, or its beginning
    SessionKeys keys{};
    ReplayWindow window{kMaxState};
    NewestOnly ticks{};

    /// True if the client receives at `endpoint`, as far as is known: it said a cookie back that was sent
    /// there, or used a sample that was sent there alone. Until then nothing large goes there: who relays a
    /// state from a forged address cannot aim pages at it (as RFC 9000, section 8.2, validates a path).
    bool is_reached() const noexcept { return endpoint == reached; }
    /// A state came in order from `from`, and its tick had used sample `newest_sample`.
    void heard_from(const Endpoint& from, std::uint64_t newest_sample) noexcept;
  };
  /// Outcome of a datagram: an answer to send back, a tool state newer than all before, or telemetry.
  struct Outcome {
    std::optional<std::pair<Header, Message>> answer{};
    Key key{};  ///< of the answer
    const ToolState* tool_state = nullptr;
    const ToolState* asking =
        nullptr;  ///< the same, or one that others overtook: the pages it asks for are wanted still
    const Telemetry* telemetry = nullptr;
    std::optional<KeyMismatch> mismatch{};  ///< of a Hello whose sender will obey no answer, or gets none
    const Member* departed = nullptr;       ///< whose session ended by this; valid until the next call
  };

  /// Random numbers for a session, should one begin; `session` not 0.
  struct Fresh {
    std::uint64_t session = 0;
    Nonce nonce{};
  };

  /// `tool_radii`: of each tool of the scene, m. `secret`: of the cookies, drawn once per run. `keys`: any of
  /// which a client may have; none: all may speak.
  ServerSessions(double rate_hz, std::vector<double> tool_radii, const Cookies::Secret& secret = {},
                 std::vector<Key> keys = {})
      : rate_hz_(rate_hz), radii_(std::move(tool_radii)), cookies_(secret), keys_(std::move(keys)) {}

  /// Sets what Welcomes say of the scene from now on; all 0 before.
  void set_scene(const ScenePrint& scene) noexcept { scene_ = scene; }

  /// A datagram that `decode_fields` accepted came.
  Outcome receive(const Datagram& datagram, const Endpoint& from, Time now, const Fresh& fresh,
                  LinkStats& stats);

  /// Writes a message as the next datagram to a member, with its header and tag; returns its size. `out`
  /// holds `kMaxDatagram` bytes.
  static std::size_t write(Member& member, const Message& message, std::span<std::byte> out) noexcept;

  /// Drops and returns members not heard for `kTimeout`.
  std::vector<Member> expire(Time now);

  /// Who holds `tool`; null when nobody does.
  Member* holder(std::uint8_t tool) noexcept;
  const std::vector<Member>& members() const noexcept { return members_; }

  static constexpr Time kTimeout = std::chrono::milliseconds(800);  ///< without a ToolState (STATES.md)
  /// Time without a ToolState after which a new Hello ends the session of its client, who speaks, but is not
  /// heard, and begins another. Longer than the 350 ms after which a client that waits for its first tick
  /// sends states.
  static constexpr Time kUnheard = std::chrono::milliseconds(400);

 private:
  Outcome greet(const Datagram& datagram, const Hello& hello, const Endpoint& from, Time now,
                const Fresh& fresh, LinkStats& stats);
  Outcome challenge(const Hello& hello, const Endpoint& from, Time now) const noexcept;
  void depart(std::vector<Member>::iterator member) noexcept;
  void spend_cookies() noexcept;
  Outcome admit(const Hello& hello, const Key& shared, const Endpoint& from, Time now, const Fresh& fresh);
  bool is_shut_out(const Member& member, const Hello& hello, Time now) const noexcept;
  Member& join(const Hello& hello, const Key& shared, const Endpoint& from, std::uint8_t tool, Time now,
               const Fresh& fresh);
  Outcome unknown(const Datagram& datagram, LinkStats& stats) const;
  const Key* key_of(const Datagram& datagram) const noexcept;
  std::uint64_t number_like(std::uint64_t session) const noexcept;
  std::optional<std::uint8_t> free_tool() noexcept;

  double rate_hz_;
  std::vector<double> radii_;
  ScenePrint scene_;
  Cookies cookies_;
  std::vector<Key> keys_;
  std::vector<Member> members_;
  Member departed_;
};

}  // namespace palpate::protocol
