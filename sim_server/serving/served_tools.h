#pragma once
#include <optional>
#include <vector>

#include "common/force_jumps.h"
#include "common/time.h"
#include "protocol/messages.h"
#include "sim_server/serving/relaxation_publisher.h"
#include "sim_server/serving/surface_pager.h"
#include "sim_server/serving/tool_path.h"
#include "sim_server/simulation/error_of_force.h"

namespace palpate::sim {

/// The newest state of a tool, and in whose session; session 0: nobody holds it.
struct SessionInput {
  std::uint64_t session = 0;
  protocol::ToolState state;
  /// True if the state came since the last step. An old pose gets no new answer, as the client must see its
  /// age.
  bool fresh = false;
  ToolPath path{};  ///< that led there; of use where contact is solved several times a step
  /// Times that the path began anew: each time the tool enters, as if it had been lifted.
  std::uint32_t beginnings = 0;

  bool was_lost = false;  ///< the newest point of the path is that of a lost device

  /// Follows the path to a state that came over a link. The path begins anew after `kGap` without a state,
  /// and after states of a lost device: where the tool went meanwhile is not known, and the straight way may
  /// lead through the organ.
  void follow(const protocol::ToolState& newest) noexcept;

  static constexpr Time kGap =
      std::chrono::milliseconds(100);  ///< three steps at 30 Hz, by the client's clock
};

/// Returns the part of a sample that tells the force and how it changes nearby.
PublishedForce published_force(const protocol::ForceSample& sample) noexcept;

/// The simulation as clients meet it, each holding a tool in a session of its own: poses in, answers out. No
/// clock, thread or socket, so it runs the same in the loop and in virtual time. One thread; no allocation
/// but where a simulation tells another surface.
class ServedTools {
 public:
  /// `errors`: of the force, for answers that are to tell them; null: none does. Both outlive this.
  explicit ServedTools(Simulation& simulation, const ErrorOfForce* errors = nullptr);

  /// Outcome of a step for one tool. `answer`: to a fresh pose only; the caller knows `step_ns`.
  struct Outcome {
    ToolForce force;
    std::optional<protocol::ForceSample> answer;
    std::uint64_t flagged_samples = 0;  ///< answers of this session so far that were flagged
  };

  /// Steps by `dt` (s), with an input for each tool. A tool that nobody holds, or whose device is lost, is
  /// lifted; this affects the others only through the tissue. Returns an outcome for each tool, valid until
  /// the next step. While nobody holds any tool, returns none and does nothing.
  std::span<const Outcome> step(std::span<const SessionInput> inputs, double dt) noexcept;

  /// While the simulation is paused: the last sample of this tool once more, with the next number, so that
  /// its client keeps the session and lets go of the force; nothing where nobody holds it. Without a step of
  /// this session yet: no force where the tool is.
  std::optional<protocol::ForceSample> paused(std::size_t tool, const SessionInput& input) noexcept;

  /// The surface that samples of a tool name by now. Another one only where `published_version` is another
  /// number.
  const std::shared_ptr<SurfacePager>& pager(std::size_t tool) const { return pagers_[tool]; }
  std::uint32_t published_version() const { return published_version_; }

 private:
  struct Holder {
    std::uint64_t session = 0, samples = 0, flagged = 0;
    std::uint32_t beginnings = 0;  // of its path
    protocol::ToolState before{};  // of the step before
    protocol::ForceSample last{};
  };
  bool hand_over(std::size_t tool, std::uint64_t session) noexcept;
  bool enters(std::size_t tool, const SessionInput& input) noexcept;
  void make_pagers();
  void follow_surface() noexcept;
  ToolInput input_of(std::size_t tool, const SessionInput& input) noexcept;
  void follow_path(std::size_t tool, const SessionInput& input, ToolInput& published) noexcept;
  protocol::ForceSample sample_of(std::size_t tool, const protocol::ToolState& state,
                                  const ToolAnswer& answer) noexcept;

  Simulation& simulation_;
  const ErrorOfForce* errors_;
  std::vector<std::shared_ptr<SurfacePager>> pagers_;  // of each tool
  std::vector<protocol::SurfaceState> surfaces_;       // of each tool; version 0: none
  std::uint32_t published_version_ = 0;
  std::optional<RelaxationPublisher> relaxation_;  // where modes of one tool are published that relax
  std::vector<Holder> holders_;
  std::vector<std::vector<PathPoint>> paths_;  // within a step, of each tool
  std::vector<ToolInput> inputs_;
  std::vector<Outcome> outcomes_;
};

}  // namespace palpate::sim
