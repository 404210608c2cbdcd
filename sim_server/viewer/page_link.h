#pragma once
/// State of one page: the data it has, and the data it is due. No clock, no socket: time is an argument.
#include <optional>

#include "common/time.h"
#include "protocol/token_bucket.h"
#include "sim_server/viewer/encoding.h"
#include "sim_server/viewer/page_message.h"
#include "sim_server/viewer/texts.h"

namespace palpate::sim {

/// Newest data of everything to show, equal for all pages. Filled by the page's thread.
struct Showing {
  const SceneFacts* scene = nullptr;
  bool live = true;  ///< false: nothing but the scene is sent, the rest stands in `/session`
  ViewBox box;
  std::uint32_t version = kCompleteSurface;             ///< of the topology: which triangles it has
  static constexpr std::uint32_t kCompleteSurface = 1;  ///< those of the scene, before anything was removed
  std::span<const Triangle> triangles{};                ///< of any later one
  const Picture* picture = nullptr;
  std::uint64_t pictures = 0;            ///< so far: another number is another picture
  std::vector<std::uint16_t> positions;  ///< (3 n) of `picture`
  std::vector<SeenPeer> peers;           ///< of each tool
  MeasuredRates rates;
  bool paused = false;
  std::vector<SeenClient> clients;                 ///< of each tool; `laws` 0: none
  std::vector<std::uint64_t> client_events;        ///< of each tool: how many came so far
  std::vector<ClientTicks> ticks;                  ///< the newest, in a ring of
  static constexpr std::size_t kTicksStored = 16;  ///< half a second of one client at 30 messages a second
  std::uint64_t ticks_so_far = 0;
  std::vector<float> field;  ///< (n), J/m3; empty: not known
  std::uint64_t fields = 0;  ///< so far
};

/// Decides what a page gets next, each time that its connection takes more: the newest, against what it has;
/// nothing waits in line. Holds 6 bytes a vertex, and of an organ that is cut 12 a triangle.
class PageLink {
 public:
  explicit PageLink(Time opened) : opened_(opened), messages_(kMessagesPerSecond, kMessagesPerSecond) {}

  /// Takes one token; true if one more message from the page may come.
  bool may_say(Time now) noexcept { return messages_.take(now); }
  /// True if the page has sent no hello within `kHelloWithin`.
  bool too_quiet(Time now) const noexcept { return !greeted_ && now - opened_ > kHelloWithin; }

  void greet(bool may_control) noexcept { greeted_ = true, may_control_ = may_control; }
  bool greeted() const noexcept { return greeted_; }
  bool may_control() const noexcept { return may_control_; }
  void want_field(bool request) noexcept { requests_field_ = request; }
  bool requests_field() const noexcept { return requests_field_; }
  /// Marks the surface of this step as drawn by the page, so earlier ones are no longer on their way.
  void shown(std::uint32_t step) noexcept;
  /// Takes the pointer of the page: it moved a tool, or pushed its buttons.
  void pointed(const PagePointer& pointer);
  /// The tools whose buttons it holds down, where it left them, with these up: of a page that is gone.
  std::vector<PagePointer> released() const;
  /// The next surface is a whole one, and so are the triangles before it, where some have been removed.
  void forget_surface() noexcept {
    received_.positions.clear();
    complete_triangles_ = received_.version > Showing::kCompleteSurface;
  }
  /// Sends the newest reason.
  void refuse(std::string why) { refused_ = std::move(why); }

  enum class Kind { kText, kBinary };
  /// The next message into `out`, and what it is; nothing where it has all there is.
  std::optional<Kind> next(const Showing& showing, Time now, Bytes& out);

  static constexpr double kMessagesPerSecond = 200;  ///< from a page; one of 60 frames a second sends 120
  static constexpr Time kHelloWithin = std::chrono::seconds(5);       ///< of opening
  static constexpr Time kStateEach = std::chrono::milliseconds(150);  ///< at least
  static constexpr std::size_t kMaxInTransit = 4;  ///< surfaces, of a page that reports what it drew
  static constexpr Time kSurfaceEach = std::chrono::milliseconds(15);  ///< at most

 private:
  std::optional<Kind> begin(const Showing& showing, Bytes& out);
  bool may_follow(Time after) const noexcept;
  bool next_surface(const Showing& showing, Time now, Bytes& out);
  bool next_sample(const Showing& showing, Bytes& out);
  bool next_of_client(const Showing& showing, Bytes& out, Kind& kind);

  Time opened_, state_at_{}, surface_at_{};
  protocol::TokenBucket messages_;
  bool greeted_ = false, may_control_ = false, requests_field_ = false, knows_scene_ = false;
  /// The newest that the page has received.
  struct Received {
    std::uint32_t version = 0;  // of the topology; 0: none
    std::uint64_t surface = 0, state = 0, field = 0, ticks = 0;
    std::vector<std::uint16_t> positions;  // (3 n)
    std::vector<Triangle> triangles;       // where the organ is cut
    std::array<std::uint64_t, kMaxTools> samples{}, clients{};
  } received_;
  bool complete_triangles_ = false;  // to be sent again
  std::string refused_;
  bool acknowledges_ = false;              // the page reports each surface that it drew
  std::vector<std::uint32_t> in_transit_;  // steps of surfaces, the oldest first
  std::vector<PagePointer> pressed_;
};

}  // namespace palpate::sim
