#pragma once
#include <deque>

#include "common/force_jumps.h"
#include "common/histogram.h"
#include "common/trajectory.h"
#include "protocol/capture.h"
#include "protocol/near_tiles.h"
#include "protocol/session.h"
#include "sim_server/serving/missed_tools.h"

namespace palpate::sim {

/// Tells how long steps take.
class StepClock {
 public:
  virtual ~StepClock() = default;
  /// A step begins at `t` of virtual time.
  virtual void begin(Time t) = 0;
  /// Ends the step and returns the time that it took.
  virtual Time took() = 0;
};

/// Settings of a session in virtual time. Hz and s.
struct VirtualLink {
  double rate_hz, ticks_hz;
  Time delay{};          ///< from reading the tool to having its force in the client
  bool parts = false;    ///< whether the client asks for all that a sample can carry
  std::size_t tool = 0;  ///< of the scene: its session stands first in the capture, and in the sums
  protocol::ScenePrint scene = {};
  /// Steps take as long as this says, as those of `SimLoop` do: a sample is on its way when its step is done,
  /// and a step that took too long puts off those after it. Null: they take none.
  StepClock* clock = nullptr;
};

/// Sums over a virtual session.
struct VirtualSessionStats {
  std::uint64_t tool_states = 0, force_samples = 0, in_contact = 0, flagged = 0;
  std::uint64_t late = 0;  ///< deadlines passed over because a step took too long
  double max_newton = 0;
  MissedTools missed;
  SnapCounter snaps{0};       ///< of the force of the link's tool, of steps at 2000 Hz or more
  UnexplainedJumps jumps;     ///< between the samples of its session
  Histogram contact_step_ns;  ///< processor time of the steps in contact, with all that the client asks for
};

/// Clients and a server that talk without sockets and clock: the two ends of the session of each tool that
/// has a motion, which it follows exactly, and a capture of every datagram between them. Other tools are
/// lifted. With `parts`, a client gets the shape of the surface right after the first sample that names it,
/// and its compliance where the tool comes near it: at once what our client would ask for there
/// (protocol/near_tiles.h), and nothing where it stays away. Clients stand at 192.0.2.1, the first at port
/// 45131, and the server at 192.0.2.2:45130 (addresses for documentation, RFC 5737).
class VirtualSession {
 public:
  /// `motions`: of the tools of the scene, in order, at least up to `link.tool`; outlive this.
  VirtualSession(Simulation& simulation, std::span<const Trajectory> motions, const VirtualLink& link,
                 protocol::CaptureWriter& capture, const ErrorOfForce* errors = nullptr);

  /// Tick number `k` from 0, in order: clients read the tools, server steps if a step is due, samples arrive.
  /// Throws `Error` for a motion or speed beyond what the protocol carries (1e9 m, m/s).
  void tick(std::uint64_t k);
  /// The clients say Bye.
  void leave();

  /// The time of tick `k`.
  Time time_of(std::uint64_t k) const;
  const VirtualSessionStats& stats() const { return stats_; }

 private:
  struct InTransit {
    Time ready;
    protocol::ForceSample sample;
  };
  /// Pages of the surface that a client has.
  struct Pages {
    std::uint32_t surface = 0;  // version of the one whose pages were sent
    protocol::NearTiles near;
    std::deque<std::uint32_t> sent = {};  // of tiles and shapes, the oldest first
    std::vector<char> has = {};           // by page from the first tile on: whether it is among them
  };
  /// Client of a tool.
  struct Client {
    std::size_t tool;
    protocol::Endpoint endpoint;
    std::uint64_t session;
    protocol::ClientSession talk;
    Pages pages;
    protocol::LinkStats stats = {};
    protocol::ToolState state = {};  // the newest
    std::uint64_t newest = 0, pages_taken = 0;
  };
  void add_client(std::size_t tool);
  void keep_session(Client& client, Time t);
  protocol::ToolState next_state(const Client& client, std::uint64_t k, Time t) const;
  void announce(Client& client, Time t);
  void send_surface(Client& client, const protocol::ForceSample& sample, Time t);
  void send_shape(Client& client, Time t);
  void keep_page(Client& client, std::uint32_t page, std::uint32_t first_tile, Time t);
  bool send_page(Client& client, std::uint32_t number, Time t);
  bool is_due(double steps_due) const;
  void step(double steps_due);
  void note(std::span<const ServedTools::Outcome> outcomes, Time took);
  Time deadline() const;
  Time pass(Time begun, Time took);
  void note_paths();
  void deliver(Time t);
  protocol::Datagram travel(const protocol::Endpoint& from, const protocol::Endpoint& to,
                            const protocol::Header& header, const protocol::Message& message, Time t);
  void to_server(Client& client, const protocol::Header& header, const protocol::Message& message, Time t);
  void to_client(Client& client, const protocol::Header& header, const protocol::Message& message, Time t);

  const Simulation& simulation_;
  ServedTools served_;
  std::vector<SessionInput> inputs_;  // nobody holds those without a motion
  std::span<const Trajectory> motions_;
  VirtualLink link_;
  protocol::CaptureWriter& capture_;
  protocol::ServerSessions server_;
  protocol::LinkStats server_stats_;
  std::vector<Client> clients_;       // by tool
  std::deque<InTransit> in_transit_;  // step by step, of each by tool
  std::uint64_t steps_ = 0;
  /// Where steps take time.
  struct Lateness {
    Time put_off_to{}, took{};      // when a late step began; what the last one took
    std::uint64_t steps_since = 0;  // the late one
  } lateness_;
  Time now_{}, answered_{};  // of the newest tool states, and of the newest that a step answered
  VirtualSessionStats stats_;
};

}  // namespace palpate::sim
