#pragma once
#include <memory>
#include <string>
#include <vector>

#include "common/background_job.h"
#include "sim_server/client_model/published_motion.h"
#include "sim_server/elasticity/tensors.h"
#include "sim_server/mesh/cut_mesh.h"

namespace palpate::sim {

/// Surface near the tools, of tissue that can be cut, as it is published to clients. Immutable except for the
/// modal state in `motion`, which only the stepping thread may use.
struct PublishedSurface {
  /// Surface vertices within `radius` of where a tool was, as the tissue stood then, m.
  struct Ball {
    Vec3 centre;
    double radius;
    bool holds(const Vec3& p, double fraction) const { return (p - centre).norm() <= fraction * radius; }
  };
  struct Part {
    std::vector<int> vertices;  ///< of the surface, ascending
    std::vector<Ball> balls;    ///< one for each tool
    /// True if the place (m) is within this fraction of the radius of some ball.
    bool holds(const Vec3& place, double fraction) const noexcept;
  };

  PublishedMotion motion;
  Part shape;           ///< whose shape and modes are published
  Part compliant;       ///< of which `motion` knows how compliant they are, too
  std::uint32_t model;  ///< another number for another `shape`, or where tissue was cut in between

  /// True if it covers all that a tool at this place (m) may touch until the next sample.
  bool covers(const Vec3& place) const noexcept { return shape.holds(place, 0.8); }
};

/// Returns how many factored bodies a scene may hold at once: the one in use, and one that is being made.
int published_bodies(const Scene& scene);

/// Computes what is published about a linear tissue in motion that can be cut: the `kShape` surface vertices
/// nearest to each tool, the slow modes, and the static compliance of all the rest at the `kCompliant`
/// nearest (`PublishedMotion`). After a cut all of it in the background, on one core: the factor and the
/// modes of what is left, once it was left alone for a tenth of a second; then the compliance, and that anew
/// as the tool goes on. What it made is in use from a step on that was fixed when it began, at any speed of
/// the machine: a step that `waits` waits for it then; else in the first that finds it made. A cut ends what
/// is published at once. So the same tools make the same bits, unless memory ends. Owned by the thread that
/// steps. Destroying it waits for the background.
class SurfacePublisher {
 private:
  struct Body;
  struct Made {
    std::shared_ptr<const Body> body;
    std::shared_ptr<PublishedSurface> surface;
  };

 public:
  /// State as a value. What the background makes is shared by its copies, and never changes.
  struct State {
    long step = 0, due = 0, last_cut = 0, not_before = 0;  // of all; when the background has its time; ...
    int failures = 0;                                      // in a row
    bool in_vain = false;                                  // what is being made: tissue was cut since
    std::uint32_t models = 0;                              // so far
    std::string failure;
    std::shared_ptr<const Body> body;    // of the remaining tissue; null: to be made
    std::shared_ptr<const Body> before;  // where that is to be made: of the tissue before the last cut
    std::shared_ptr<PublishedSurface> surface;
    Eigen::VectorXd amplitudes, rates;  // of `surface`, when it was saved
    BackgroundJob<Made> work;
  };
  static constexpr std::size_t kShape = 1500, kCompliant = 250;  ///< a tool: 5 MB of compliance

  /// Computes factor and modes of the uncut body, of a scene with a rate. Throws `Error` as `LinearStatics`
  /// and `vibration_modes`.
  SurfacePublisher(const ModelInputs& inputs, const ElasticTensors& tensors);

  /// Tissue has been cut: the published surface is out of date.
  void forget() noexcept;

  using Tool = ClientModel::Tool;
  /// The tissue as it is by now.
  struct Tissue {
    const CutMesh& remaining;
    std::span<const Vec3> positions;  ///< of surface vertices, m
    const ElasticTensors& tensors;
  };
  /// A step begins. `waits`: for the background, as above; else what it made is in use as soon as it is
  /// there, and what is published depends on the machine. Allocates where it begins or ends anything,
  /// O(tetrahedra).
  void step(std::span<const Tool> tools, const Tissue& tissue, bool waits = true);

  /// Null: nothing.
  PublishedSurface* surface() const noexcept { return now_.surface.get(); }
  std::shared_ptr<const PublishedSurface> shared() const noexcept { return now_.surface; }
  /// Returns the time (s) from the last cut until the surface is published again, where a client requests it.
  double delay() const noexcept { return (calm_steps_ + body_steps_ + surface_steps_) * period_; }
  const std::string& failure() const noexcept { return now_.failure; }  ///< the last one; empty: none
  std::size_t bytes() const noexcept;

  State save() const;
  void restore(const State& state);

 private:
  void start_next(std::span<const Tool> tools, const Tissue& tissue);
  void start_body(const Tissue& tissue);
  void start_surface(std::span<const Tool> tools, const Tissue& tissue);
  template <class Make>
  void begin(int steps, Make make);
  bool is_due(bool waits) const;
  void end();
  void put_off(const std::exception& failure);
  Vec3 expected_place(const Tool& tool) const;

  Scene scene_;
  Surface surface_;  // without triangles
  std::vector<int> fixed_;
  double period_;                                // s, of a step
  int calm_steps_, body_steps_, surface_steps_;  // before it begins; until either is in use
  State now_;
};

}  // namespace palpate::sim
