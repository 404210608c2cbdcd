#pragma once
/// Data that a page shows, as small structs, independent of how a session is served.
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/contact/tool.h"
#include "common/contact/vertex_load.h"
#include "common/discretisation_error.h"
#include "protocol/messages.h"
#include "sim_server/mesh/tet_mesh.h"
#include "sim_server/simulation/strain_range.h"

namespace palpate::sim {

/// The surface of the organ at rest: n vertices, m triangles.
struct OrganShape {
  std::vector<Vec3> rest;           ///< (n), m, world
  std::vector<Triangle> triangles;  ///< (m), outward
  enum Flag : std::uint8_t { kFixed = 1, kInReach = 2 };
  std::vector<std::uint8_t> flags;  ///< (n), bits of `Flag`
};

/// Facts of the scene that the page gets before anything moves.
struct SceneFacts {
  std::string title, file, model;
  double rate_hz = 0;
  std::vector<Tool> tools;  ///< 1 to `kMaxTools`
  OrganShape organ;
  std::vector<std::string> gallery{};  ///< other scenes that may be chosen; empty: none
  bool pausable = false;               ///< whether who has the token may pause it
  bool recorded = false;
  bool blades = false;                ///< whether one may part the organ
  std::vector<std::string> fields{};  ///< what the organ can be coloured by here
};

/// State of one tool after a step. World frame, m, N.
struct SeenTool {
  static constexpr std::size_t kMostLoads = 64;  ///< arrows; a contact of `liver_friction.toml` has some 20
  bool held = false, contact = false, flagged = false;
  ToolPose pose;
  Vec3 f_W = Vec3::Zero();
  std::size_t load_count = 0;  ///< of `loads`, at most `kMostLoads`: the rest is not shown
  std::array<VertexLoad, kMostLoads> loads{};
  /// Newest force sample of the tool; number 0: none yet.
  struct Sample {
    std::uint64_t number = 0;
    double t = 0;  ///< s, as `Picture::t`
    float force = 0;
    std::uint32_t flags = 0;
  } sample;
  std::uint64_t flagged_samples = 0;  ///< of this holder so far
  DiscretisationErrors errors{};      ///< of that force, where its client asks for them
};

/// Results of a resection. m^3, m^2, m. Distances are from the plan: of tissue removed by heat, and of faces
/// separated by a blade; NaN where there is none.
struct SeenResection {
  std::uint64_t tetrahedra = 0;  ///< gone
  double volume = 0, cut_area = 0;
  double mean_distance = std::numeric_limits<double>::quiet_NaN(), furthest = mean_distance,
         mean_separated_distance = mean_distance;
  int loose_pieces = 0;
};

/// The organ and its tools after a step: what the simulation thread hands over.
struct Picture {
  double t = 0;                  ///< s since the server began
  std::uint64_t step = 0;        ///< steps so far
  double simulated = 0;          ///< s that they advanced the tissue by, in all
  double step_ms = 0;            ///< how long the newest took
  std::uint64_t late = 0;        ///< deadlines passed over
  std::vector<float> positions;  ///< (3 n), m, world
  /// Number of steps so far in which tissue has been removed; and the triangles since, where it is more than
  /// 0.
  std::uint32_t cuts = 0;
  std::vector<Triangle> triangles{};
  std::optional<SeenResection> resection{};  ///< of an organ that can be cut
  std::optional<StrainRange> strain{};       ///< so far; none: no law of tissue
  std::array<SeenTool, kMaxTools> tools{};
};

/// Who holds a tool, as the network thread sees him.
struct SeenPeer {
  bool held = false;
  std::array<char, 56> address{};  ///< "1.2.3.4:567", ended by 0
  double loss_percent = 0, rate_hz = 0;
};

/// Tool position that the mouse of a page requests. `number` grows with each.
struct PagePointer {
  std::uint8_t tool = 0;
  Vec3 p_W = Vec3::Zero();  ///< m
  std::uint16_t buttons = 0;
  std::uint64_t number = 0;
};

/// State that only the client of a tool knows, about ten times a second while a page is open.
struct SeenClient {
  static constexpr std::size_t kMostLaws = protocol::Telemetry::kMostLaws;
  static constexpr std::size_t kMostInterventions =  // all that the message counts
      sizeof(protocol::Telemetry::Interventions) / sizeof(std::uint32_t);
  static constexpr std::size_t kMostStates = 8;  ///< at least one for each flag of `Telemetry` but the motors
  using Name = std::array<char, 32>;             ///< ended by 0
  std::uint8_t tool = 0, laws = 0, interventions = 0, states = 0;
  Name law{};  ///< the rendered one; behind a colon, its substitute
  std::array<Name, kMostLaws> law_names{};
  std::array<float, kMostLaws> errors_percent{};  ///< NaN: not scored
  /// Errors of the force on the hand, %, NaN: not known: at most this in all (no name), then its parts.
  static constexpr std::size_t kMostParts = protocol::Telemetry::kMostParts;
  std::array<Name, kMostParts> part_names{};
  std::array<float, kMostParts> parts_percent = [] {
    std::array<float, kMostParts> unknown{};
    unknown.fill(std::numeric_limits<float>::quiet_NaN());
    return unknown;
  }();
  std::array<Name, kMostInterventions> intervention_names{};
  std::array<std::uint64_t, kMostInterventions> intervention_counts{};
  std::array<Name, kMostStates> state_names{};  ///< what holds now: "fault", "clutched", ...
  double age_ms = 0, period_ms = 0, passivity_gain = 0;
  std::uint64_t missed = 0;
  Vec3 rendered_W = Vec3::Zero();  ///< N
  Vec3 p_W = Vec3::Zero();         ///< m
  Name device{};
  bool has_motors = false;
};

/// A stretch of a client's ticks: magnitudes of forces, N.
struct ClientTicks {
  static constexpr std::size_t kMost = protocol::Telemetry::kMostTicks;
  std::uint8_t tool = 0, laws = 0;
  std::uint32_t count = 0;
  double t = 0;  ///< s, of the first, as `Picture::t`
  float dt = 0;  ///< s
  std::array<float, kMost> rendered{};
  std::array<std::array<float, SeenClient::kMostLaws>, kMost> by_law{};
};

}  // namespace palpate::sim
