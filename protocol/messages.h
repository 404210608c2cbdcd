#pragma once
/// Messages of the protocol. Byte layout and meaning: protocol/README.md. Each message lists its fields once,
/// in wire order, with the limits of their values: writer, reader and check of limits walk that list, and
/// scripts/wireshark/make_fields prints it for the dissector.
#include <algorithm>
#include <array>
#include <cstdint>
#include <variant>

#include "common/contact/linearisation.h"
#include "common/damped_mode.h"
#include "common/discretisation_error.h"
#include "common/relaxation.h"

namespace palpate::protocol {

/// Every message there is or is planned; the numbers never change.
enum class MessageType : std::uint8_t {
  kHello = 1,         ///< client: let me in
  kChallenge = 2,     ///< server: say this back, to show that you receive at your address
  kWelcome = 3,       ///< server: you are in
  kRefuse = 4,        ///< server: you are not, and why
  kBye = 5,           ///< either: I am leaving
  kToolState = 6,     ///< client: where the tool is
  kForceSample = 7,   ///< server: the force computed for a tool state
  kTelemetry = 8,     ///< client: loop, laws, safety, while a page is open
  kPointer = 9,       ///< server: the mouse of a page as a device
  kSurfacePage = 10,  ///< server: a page of the surface model
};

enum class RefuseReason : std::uint8_t {
  kNoFreeTool = 1,      ///< every tool of the scene is in somebody's hand
  kUnknownSession = 2,  ///< the session is not (or no longer) known here: say Hello again
  kVersion = 3,         ///< the server speaks only the version of this datagram
};

/// Limits of a number on the wire: what is outside is a bug or an attack.
struct Range {
  double least, most;
  bool is_open = false;  ///< `least` itself is outside
};
/// Limits of a vector or quaternion on the wire: its length is 1.
struct UnitLength {
  double tolerance;  ///< of the square of the length
  bool or_zero;      ///< a length of 0 says that there is none
};

/// Largest position, speed, force or tangent on the wire, m, m/s, N, N/m.
constexpr double kMaxMagnitude = 1e9;
/// Each client reserves memory for a surface model of this size (`SurfaceModel`, 11 MB).
constexpr std::uint32_t kMostSurfaceVertices = 20'000;

namespace limits {
constexpr Range kAnyReal{-kMaxMagnitude, kMaxMagnitude};  ///< of a real number without other limits
constexpr Range kToolNumber{0, 7};
constexpr Range kFromOne{1, 2e19};                                 ///< any integer but 0
constexpr Range kTime{-2305843009213693952, 2305843009213693952};  ///< ns, 73 years: two can be subtracted
constexpr Range kRate{0, 1e6};                                     ///< Hz
constexpr Range kLead{0, 1e10};                                    ///< ns
constexpr Range kToolRadius{0, 1, true}, kToolRadiusOrNone{0, 1};  ///< m
constexpr Range kFriction{0, 10};
constexpr Range kToolCompliance{0, 1e6}, kCompliance{-1e6, 1e6};  ///< m/N
constexpr Range kGap{0, kMaxMagnitude};                           ///< m
constexpr Range kAmplitude{-1e6, 1e6};          ///< of a mode, m sqrt(kg), and of its rate, load and memory
constexpr Range kRelaxationTime{0, 1e6, true};  ///< s
constexpr Range kPercent{0, 1e6};               ///< of an error of a force
constexpr Range kPercentOrUnknown{-4e38, 1e6};  ///< below 0: not known
constexpr Range kFraction{0, 1};
constexpr Range kModes{0, kMaxPublishedModes};
constexpr Range kRelaxations{0, kMostRelaxations};
constexpr Range kVertices{0, kMostSurfaceVertices}, kTriangles{0, 2 * kMostSurfaceVertices};
constexpr Range kPageNumber{0, 4294967294};  ///< any but `ToolState::kNoPage`
constexpr UnitLength kUnitVector{1e-6, false}, kUnitVectorOrZero{1e-6, true};
}  // namespace limits

/// Drawn at random, once; on the wire 16 bytes.
using Nonce = std::array<std::uint64_t, 2>;
/// Number that a server sends to an address and expects back from there; on the wire 16 bytes.
using Cookie = std::array<std::uint64_t, 2>;

struct Hello {
  static constexpr MessageType kType = MessageType::kHello;
  Nonce nonce = {};           ///< drawn by the client once per run: tells its retries from a second client
  Cookie cookie = {};         ///< that of the newest Challenge; zero before one came
  std::uint64_t attempt = 0;  ///< counts the Hellos of a run, so that no old answer passes for a new one
  template <class Self, class Visitor>
  static void fields(Self& m, Visitor&& v) {
    v(m.nonce), v(m.cookie), v(m.attempt);
  }
};

struct Challenge {
  static constexpr MessageType kType = MessageType::kChallenge;
  Nonce nonce = {};  ///< of the Hello this answers, as is:
  std::uint64_t attempt = 0;
  Cookie cookie = {};  ///< to be said in the next
  template <class Self, class Visitor>
  static void fields(Self& m, Visitor&& v) {
    v(m.nonce), v(m.attempt), v(m.cookie);
  }
};

/// Hashes of what the forces of a scene follow from, by which a capture is known to be of it. All 0: not
/// known.
struct ScenePrint {
  std::uint32_t mesh = 0;      ///< tetrahedra at rest, before the first cut
  std::uint32_t material = 0;  ///< with inclusions, and what cutting takes
  std::uint32_t supports = 0;  ///< fixed vertices and loads
  std::uint32_t tools = 0;     ///< their shapes, and the name of the model
  bool operator==(const ScenePrint&) const = default;
  template <class Self, class Visitor>
  static void fields(Self& m, Visitor&& v) {
    v(m.mesh), v(m.material), v(m.supports), v(m.tools);
  }
};

struct Welcome {
  static constexpr MessageType kType = MessageType::kWelcome;
  Nonce nonce = {};  ///< of the Hello this answers, as is:
  std::uint64_t attempt = 0;
  Nonce server = {};       ///< drawn by the server for this session
  std::uint8_t tool = 0;   ///< the tool of the scene this client holds
  double rate_hz = 0;      ///< steps per second the server aims for; 0 = as fast as it can
  double tool_radius = 0;  ///< m
  ScenePrint scene{};      ///< of which the forces are
  template <class Self, class Visitor>
  static void fields(Self& m, Visitor&& v) {
    v(m.nonce), v(m.attempt), v(m.server), v(m.tool, limits::kToolNumber), v(m.rate_hz, limits::kRate),
        v(m.tool_radius, limits::kToolRadius);
    ScenePrint::fields(m.scene, v);
  }
};

struct Refuse {
  static constexpr MessageType kType = MessageType::kRefuse;
  Nonce nonce = {};           ///< of the Hello this answers, as is:
  std::uint64_t attempt = 0;  ///< (both 0 when it answers something else)
  RefuseReason reason = RefuseReason::kNoFreeTool;
  template <class Self, class Visitor>
  static void fields(Self& m, Visitor&& v) {
    v(m.nonce), v(m.attempt), v(m.reason);
  }
};

struct Bye {
  static constexpr MessageType kType = MessageType::kBye;
  template <class Self, class Visitor>
  static void fields(Self&, Visitor&&) {}
};

struct ToolState {
  static constexpr MessageType kType = MessageType::kToolState;
  /// Bits of `flags`: what this tick saw, and which parts of the answer it asks for.
  enum Flag : std::uint16_t {
    kDeviceLost = 1,
    kRearmed = 2,
    kClutched = 4,
    kRequestsTangent = 8,
    kRequestsAhead = 16,
    kRequestsSurface = 32,
    kAsksPages = 64,
    kRequestsErrors = 128,
    kInPause = 256,
    kHasEarlierTicks = 512,  ///< ticks before this one stand behind it (protocol/earlier_ticks.h)
    kRequestsUplink = 1024,
  };
  static constexpr std::uint32_t kNoPage = 0xffffffff;
  std::uint8_t tool = 0;
  std::uint64_t tick = 0;           ///< haptic tick, from 1
  std::uint64_t newest_sample = 0;  ///< number of the newest ForceSample this tick used; 0 = none yet
  std::int64_t t_ns = 0;            ///< when the device was read, on the client's own clock
  Vec3 p_W = Vec3::Zero();          ///< tool centre, m
  Vec3 v_W = Vec3::Zero();          ///< its velocity, m/s
  std::array<double, 4> q_W = {1, 0, 0, 0};  ///< orientation, unit quaternion w, x, y, z
  std::uint16_t buttons = 0;                 ///< one bit each
  std::uint16_t flags = 0;
  std::int64_t lead_ns = 0;  ///< with kRequestsAhead: how much later the middle of the answer's use will be
  std::uint64_t pages_taken = 0;            ///< kRequestsSurface: pages that this tick and those before took
  std::uint32_t surface_version = 0;        ///< kAsksPages: of the model that is asked for, and
  std::array<std::uint32_t, 8> pages = {};  ///< which of its pages; kNoPage: none
  template <class Self, class Visitor>
  static void fields(Self& m, Visitor&& v) {
    v(m.tool, limits::kToolNumber), v(m.tick, limits::kFromOne), v(m.newest_sample), v(m.t_ns, limits::kTime),
        v(m.p_W), v(m.v_W), v(m.q_W, limits::kUnitVector), v(m.buttons), v(m.flags);
    if ((m.flags & kRequestsAhead) != 0) v(m.lead_ns, limits::kLead);
    if ((m.flags & kRequestsSurface) != 0) v(m.pages_taken);
    if ((m.flags & kAsksPages) != 0) v(m.surface_version), v(m.pages);
  }
};

/// Visits a `Linearisation` without its place and force, which a message has beside it.
template <class Self, class Visitor>
void linearisation_fields(Self& m, Visitor&& v) {
  v(m.tangent), v(m.normal_W, limits::kUnitVectorOrZero), v(m.gap, limits::kGap);
}

/// Which model of the surface the tool can touch there is (its pages: `SurfacePage`), and where it stands.
struct SurfaceState {
  std::uint32_t version = 0;  ///< of the model; another number is another model
  std::uint32_t vertices = 0, triangles = 0;
  double tool_radius = 0;       ///< m
  double tool_friction = 0;     ///< Coulomb's coefficient; 0 = slips freely
  double tool_compliance = 0;   ///< m/N, isotropic, between the tool and its tip; 0 = rigid
  Vec3 shift_W = Vec3::Zero();  ///< from rest to where the surface near the tool is free of it, m
  template <class Self, class Visitor>
  static void fields(Self& m, Visitor&& v) {
    v(m.version), v(m.vertices, limits::kVertices), v(m.triangles, limits::kTriangles),
        v(m.tool_radius, limits::kToolRadiusOrNone), v(m.tool_friction, limits::kFriction),
        v(m.tool_compliance, limits::kToolCompliance), v(m.shift_W);
  }
};

/// Visits `OtherTools`.
template <class Self, class Visitor>
void other_tools_fields(Self& m, Visitor&& v) {
  v(m.v_W), v(m.compliance, limits::kCompliance);
}

/// State of the slow modes of a body in motion; their shapes on its surface: `SurfacePage`s.
struct ModalState {
  std::uint8_t count = 0;  ///< of modes, at most `kMaxPublishedModes`
  /// Amplitudes of the first `count` modes, m sqrt(kg), and their rates, m sqrt(kg)/s.
  std::array<float, kMaxPublishedModes> q = {}, v = {};
  template <class Self, class Visitor>
  static void fields(Self& m, Visitor&& v) {
    v(m.count, limits::kModes);
    for (std::size_t k = 0; k < m.count && k < m.q.size(); ++k)
      v(m.q[k], limits::kAmplitude), v(m.v[k], limits::kAmplitude);
  }
};

/// Loads of the other tools on the slow modes of a body in motion.
struct ModalLoads {
  /// Returns how many of `modes`, the slowest first, have room for loads, beside all other parts but
  /// "relaxed" (75: 10; up to 53: all).
  static constexpr std::size_t room(std::size_t modes) { return std::min(modes, 160 - 2 * modes); }
  std::uint8_t count = 0;                           ///< of modes, the slowest first; none for the others
  std::array<float, kMaxPublishedModes> load = {};  ///< of the first `count`, N/sqrt(kg)
  template <class Self, class Visitor>
  static void fields(Self& m, Visitor&& v) {
    v(m.count, limits::kModes);
    for (std::size_t k = 0; k < m.count && k < m.load.size(); ++k) v(m.load[k], limits::kAmplitude);
  }
};

/// Viscous memory of a body that moves and relaxes, in addition to its `ModalState`. Each sample contains one
/// part of it and the next sample the next part, as all of it would not fit into a datagram.
struct RelaxedState {
  static constexpr std::size_t kMostAmplitudes = kMaxPublishedModes;  ///< in one sample: a term of all modes
  static constexpr std::size_t kMostForces = 16;                      ///< in one sample
  static constexpr Range kForces{0, kMostForces};
  /// The Prony series, at most `kMostRelaxations` terms: share of the stress at once, and time, s.
  std::uint8_t terms = 0;
  std::array<float, kMostRelaxations> fraction = {}, time = {};
  /// Delayed amplitudes of `count` modes from `first` on: z follows q late in each term, m sqrt(kg); terms of
  /// a mode in a row.
  std::uint8_t first = 0, count = 0;
  std::array<float, kMostAmplitudes> z = {};
  /// Viscous memory of vertices of the surface: their delayed force in each term, N.
  struct Vertex {
    std::uint16_t number = 0;
    std::array<float, 3 * kMostRelaxations> psi = {};
  };
  std::uint8_t vertices = 0;
  std::array<Vertex, kMostForces> vertex = {};
  template <class Self, class Visitor>
  static void fields(Self& m, Visitor&& v) {
    v(m.terms, limits::kRelaxations);
    const auto terms = std::min<std::size_t>(m.terms, kMostRelaxations);
    for (std::size_t j = 0; j < terms; ++j)
      v(m.fraction[j], limits::kFraction), v(m.time[j], limits::kRelaxationTime);
    v(m.first, limits::kModes), v(m.count, limits::kModes);
    for (std::size_t i = 0; i < m.count * terms && i < m.z.size(); ++i) v(m.z[i], limits::kAmplitude);
    v(m.vertices, kForces);
    for (std::size_t i = 0; i < m.vertices && (i + 1) * terms <= kMostForces && i < m.vertex.size(); ++i) {
      v(m.vertex[i].number);
      for (std::size_t k = 0; k < 3 * terms; ++k) v(m.vertex[i].psi[k], limits::kAmplitude);
    }
  }
};

/// Counts of the datagrams of a session, as the server has heard them.
struct UplinkCounts {
  std::uint32_t came = 0;  ///< datagrams, without duplicates
  std::uint32_t lost = 0;  ///< sequence numbers up to the highest that came, without those that came
  template <class Self, class Visitor>
  static void fields(Self& m, Visitor&& v) {
    v(m.came), v(m.lost);
  }
};

struct ForceSample {
  static constexpr MessageType kType = MessageType::kForceSample;
  /// Bits of `flags`. Those called `kHas...` say which parts follow.
  enum Flag : std::uint32_t {
    kInContact = 1,
    kFlagged = 2,
    kHasTangent = 4,
    kHasAhead = 8,
    kHasSurface = 16,
    kHasErrors = 32,
    kHasOthers = 64,
    kHasModes = 128,
    kHasMean = 256,
    kHasRelaxed = 512,
    kRequestsTelemetry = 1024,  ///< the client is to send `Telemetry`
    kPaused = 2048,  ///< release the force: the simulation is paused, and this sample repeats the last one
    kHasModalLoads = 4096,
    kHasCuts = 8192,
    kCutting = 16384,  ///< the tip was hot, or the blade cut: what it touches may give way at any time
    /// Beside kFlagged, why: one of these, in the order of `Doubt`.
    kFailed = 32768,
    kRanAway = 65536,
    kInsideOut = 131072,
    kNotBalanced = 262144,
    kToolsUnsettled = 524288,
    kContactUnsettled = 1048576,
    kOutsideReach = 2097152,
    kStrained = 4194304,  ///< the tissue under the tool, beyond what its law is meant for
    kHasUplink = 8388608,
  };
  std::uint8_t tool = 0;
  std::uint64_t number = 0;     ///< of this sample in its session, from 1
  std::uint64_t tool_tick = 0;  ///< echoed from the ToolState it answers, as are:
  std::int64_t tool_t_ns =
      0;                    ///< the client's own time stamp, so that force age needs no clock synchronisation
  Vec3 p_W = Vec3::Zero();  ///< the tool position the force was computed for, m
  Vec3 f_W = Vec3::Zero();  ///< force on the tool, N
  Vec3 torque_W = Vec3::Zero();  ///< torque on the tool about its centre, N m
  std::int64_t step_ns = 0;      ///< time the server spent on the step
  std::uint32_t flags = 0;
  Vec3 surface_v_W = Vec3::Zero();  ///< kHasTangent: of the surface near the tool, by its supports alone, m/s
  Linearisation at_tool{};          ///< kHasTangent: at p_W
  Vec3 ahead_p_W = Vec3::Zero();    ///< kHasAhead: where the tool was expected `lead` later, m
  Vec3 ahead_f_W = Vec3::Zero();    ///< kHasAhead: the force there, N
  Linearisation ahead{};            ///< kHasAhead: at that place
  SurfaceState surface{};           ///< kHasSurface
  DiscretisationErrors errors{};    ///< kHasErrors
  OtherTools others{};              ///< kHasOthers
  ModalState modes{};               ///< kHasModes, with kHasSurface: at `tool_t_ns`, under `f_W`
  Vec3 mean_f_W = Vec3::Zero();     ///< kHasMean: the mean force over the step that ended there, N
  RelaxedState relaxed{};           ///< kHasRelaxed, with kHasModes
  ModalLoads modal_loads{};         ///< kHasModalLoads, with kHasModes: by the other tools, at `tool_t_ns`
  /// kHasCuts: in how many steps so far tissue has been removed. Where it differs from that of another
  /// sample, the two are of other surfaces.
  std::uint32_t cuts = 0;
  UplinkCounts uplink{};  ///< kHasUplink
  template <class Self, class Visitor>
  static void fields(Self& m, Visitor&& v) {
    v(m.tool, limits::kToolNumber), v(m.number, limits::kFromOne), v(m.tool_tick),
        v(m.tool_t_ns, limits::kTime), v(m.p_W), v(m.f_W), v(m.torque_W), v(m.step_ns), v(m.flags);
    if ((m.flags & kHasTangent) != 0) v(m.surface_v_W), linearisation_fields(m.at_tool, v);
    if ((m.flags & kHasAhead) != 0) v(m.ahead_p_W), v(m.ahead_f_W), linearisation_fields(m.ahead, v);
    if ((m.flags & kHasSurface) != 0) SurfaceState::fields(m.surface, v);
    if ((m.flags & kHasErrors) != 0) {
      v(m.errors.mesh.source), v(m.errors.mesh.percent, limits::kPercent);
      v(m.errors.time_step.source), v(m.errors.time_step.percent, limits::kPercent);
    }
    if ((m.flags & kHasOthers) != 0) other_tools_fields(m.others, v);
    if ((m.flags & kHasModes) != 0) ModalState::fields(m.modes, v);
    if ((m.flags & kHasMean) != 0) v(m.mean_f_W);
    if ((m.flags & kHasRelaxed) != 0) RelaxedState::fields(m.relaxed, v);
    if ((m.flags & kHasModalLoads) != 0) ModalLoads::fields(m.modal_loads, v);
    if ((m.flags & kHasCuts) != 0) v(m.cuts);
    if ((m.flags & kHasUplink) != 0) UplinkCounts::fields(m.uplink, v);
  }
};

/// A page of the model of a surface, for a client that solves contact itself; what its numbers are:
/// protocol/surface_pages.h. Sent once per request, and never changes.
struct SurfacePage {
  static constexpr MessageType kType = MessageType::kSurfacePage;
  /// Vertices of a tile. Six would make 18 x 18 floats, more than `kMaxDatagram` bytes.
  static constexpr std::size_t kCluster = 5;
  static constexpr std::size_t kValues = 3 * kCluster * 3 * kCluster;  ///< of a tile, row by row
  std::uint8_t tool = 0;
  std::uint32_t version = 0;  ///< of the model
  std::uint32_t page = 0;     ///< which
  std::array<float, kValues> values = {};
  template <class Self, class Visitor>
  static void fields(Self& m, Visitor&& v) {
    v(m.tool, limits::kToolNumber), v(m.version), v(m.page, limits::kPageNumber), v(m.values);
  }
};

/// State that only the client knows, for a page that shows it: the newest ticks, and the quality of the
/// session. Sent about 30 times a second while the newest sample has the flag `kRequestsTelemetry`. It
/// changes nothing.
struct Telemetry {
  static constexpr MessageType kType = MessageType::kTelemetry;
  /// A full message has 218 + 4 x 24 x (1 + 8) bytes and fits into `kMaxDatagram` with header and tag.
  static constexpr std::size_t kMostTicks = 24, kMostLaws = 8, kMostParts = 8, kNameBytes = 32;
  static constexpr std::size_t kLastColumn = 15;  ///< of `kMostLaws` and `kMostParts`
  static constexpr Range kTicks{0, kMostTicks}, kLaws{0, kMostLaws}, kColumn{0, kLastColumn};
  /// Bits of `flags`.
  enum Flag : std::uint16_t {
    kHasMotors = 1,
    kFault = 2,
    kClutched = 4,
    kDeviceLost = 8,
    kFading = 16,
    kPaused = 32,
    kUnsettled = 64,  ///< the force is flagged for so long that it fades
  };
  using Name = std::array<std::uint8_t, kNameBytes>;  ///< ASCII, then zeros
  std::uint8_t tool = 0;
  std::uint16_t flags = 0;
  std::int64_t t_ns = 0;    ///< of the newest tick, on the client's own clock
  std::uint32_t dt_ns = 0;  ///< between two of the ticks below
  Vec3 p_W = Vec3::Zero();  ///< where the tool is by now, m
  Vec3 f_W = Vec3::Zero();  ///< rendered force there, N
  std::int64_t age_ns = 0;  ///< of the newest sample: the largest since the message before
  struct Loop {
    std::uint32_t period_ns = 0;          ///< of the loop since the message before, mean
    std::uint32_t longest_period_ns = 0;  ///< and longest
    std::uint64_t ticks = 0, missed = 0;  ///< of the session
  };
  Loop loop{};
  float passivity_gain = 1;  ///< [0, 1]
  /// Counts of the session: how often the force was faded; ticks in which the limiter cut it (force, slew),
  /// or passivity damped it.
  struct Interventions {
    std::uint32_t faded = 0, clamped = 0, slewed = 0, damped = 0;
  };
  Interventions interventions{};
  Name device = {};
  Name rendered_law = {};  ///< the rendered law; behind a colon, its substitute
  /// The law of column `named`, and its mean error so far, %, below 0: not known. Behind all laws, without a
  /// name, stands the force on the hand: at most this is its mean error, by mesh, time step, extrapolation
  /// and safety chain together; behind that its measured parts and the worst tick, by their names in the
  /// client's report. Another one in each message.
  std::uint8_t named = 0;
  Name name = {};
  float error_percent = -1;
  /// The ticks, the oldest first: the rendered force, and by each law that runs beside, N. Sizes, not
  /// vectors.
  std::uint8_t laws = 0, count = 0;
  std::array<float, kMostTicks> rendered = {};
  std::array<float, kMostTicks* kMostLaws> by_law = {};  ///< `laws` of a tick in a row
  template <class Self, class Visitor>
  static void fields(Self& m, Visitor&& v) {
    v(m.tool, limits::kToolNumber), v(m.flags), v(m.t_ns), v(m.dt_ns), v(m.p_W), v(m.f_W), v(m.age_ns),
        v(m.loop.period_ns), v(m.loop.longest_period_ns), v(m.loop.ticks), v(m.loop.missed),
        v(m.passivity_gain, limits::kFraction), v(m.interventions.faded), v(m.interventions.clamped),
        v(m.interventions.slewed), v(m.interventions.damped), v(m.device), v(m.rendered_law),
        v(m.named, kColumn), v(m.name), v(m.error_percent, limits::kPercentOrUnknown), v(m.laws, kLaws),
        v(m.count, kTicks);
    for (std::size_t i = 0; i < m.count && i < kMostTicks; ++i) v(m.rendered[i]);
    for (std::size_t i = 0; i < m.count * m.laws && i < m.by_law.size(); ++i) v(m.by_law[i]);
  }
};

/// Tool position that the mouse of a page requests, for a client whose device is that mouse; others ignore
/// it.
struct Pointer {
  static constexpr MessageType kType = MessageType::kPointer;
  std::uint8_t tool = 0;
  std::uint64_t number = 0;   ///< from 1, higher in each
  Vec3 p_W = Vec3::Zero();    ///< m
  std::uint16_t buttons = 0;  ///< one bit each
  template <class Self, class Visitor>
  static void fields(Self& m, Visitor&& v) {
    v(m.tool, limits::kToolNumber), v(m.number, limits::kFromOne), v(m.p_W), v(m.buttons);
  }
};

using Message = std::variant<Hello, Challenge, Welcome, Refuse, Bye, ToolState, ForceSample, SurfacePage,
                             Telemetry, Pointer>;

}  // namespace palpate::protocol
