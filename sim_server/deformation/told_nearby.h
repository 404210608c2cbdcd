#pragma once
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "sim_server/deformation/told_motion.h"
#include "sim_server/elasticity/tensors.h"
#include "sim_server/mesh/cut_mesh.h"

namespace palpate::sim {

/// What clients are told of a surface that can be cut, near the tools. Never changes but for the state that
/// `motion` projects, which only the thread that steps may ask it for.
struct ToldSurface {
  /// Surface vertices within `radius` of where a tool was, as the tissue stood then, m.
  struct Ball {
    Vec3 centre;
    double radius;
    bool holds(const Vec3& p, double share) const { return (p - centre).norm() <= share * radius; }
  };
  struct Part {
    std::vector<int> vertices;  ///< of the surface, ascending
    std::vector<Ball> balls;    ///< one for each tool
    /// Whether the place (m) is within this share of the radius of some ball.
    bool holds(const Vec3& place, double share) const noexcept;
  };

  ToldMotion motion;
  Part shape;           ///< whose shape and modes are told
  Part compliant;       ///< of which `motion` knows how compliant they are, too
  std::uint32_t model;  ///< another number for another `shape`, or where tissue was cut in between

  /// Whether it tells of all that a tool at this place (m) may touch until the next sample.
  bool covers(const Vec3& place) const noexcept { return shape.holds(place, 0.8); }
};

/// How many factored bodies at once that may take of a scene: one, and another one while it is made.
int told_bodies(const Scene& scene);

/// Makes what clients are told of a linear tissue in motion that can be cut: the `kShape` surface vertices
/// nearest to each tool, the slow modes, and the static compliance of all the rest at the `kCompliant`
/// nearest (`ToldMotion`). After a cut all of it in the background, on one core: the factor and the modes of
/// what is left, once it was left alone for a tenth of a second; then the compliance, and that anew as the
/// tool goes on. What it made is in use from a step on that was fixed when it began, at any speed of the
/// machine: a step that `waits` waits for it then; else in the first that finds it made. A cut ends what is
/// told at once. So the same tools make the same bits, unless memory ends. Owned by the thread that steps.
/// Destroying it waits for the background.
class ToldNearby {
 public:
  static constexpr std::size_t kShape = 1500, kCompliant = 250;  ///< a tool: 5 MB of compliance

  /// Of a scene with a rate. Makes factor and modes of the whole body. Throws `Error` as `LinearStatics` and
  /// `vibration_modes`.
  ToldNearby(const ModelInputs& inputs, const ElasticTensors& tensors);

  /// Tissue has been cut: what was told is of one that is no more.
  void forget() noexcept;

  using Tool = DeformationModel::ToldTool;
  /// The tissue as it is by now.
  struct Tissue {
    const CutMesh& left;
    std::span<const Vec3> positions;  ///< of surface vertices, m
    const ElasticTensors& tensors;
  };
  /// A step begins. `waits`: for the background, as above; else what it made is in use as soon as it is
  /// there, and what is told depends on the machine. Allocates where it begins or ends anything,
  /// O(tetrahedra).
  void step(std::span<const Tool> tools, const Tissue& tissue, bool waits = true);

  /// Null: nothing.
  ToldSurface* told() const noexcept { return told_.get(); }
  std::shared_ptr<const ToldSurface> shared() const noexcept { return told_; }
  /// From the last cut to when the surface is told anew, where a client wants it, s.
  double delay() const noexcept { return (calm_steps_ + body_steps_ + surface_steps_) * period_; }
  const std::string& failure() const noexcept { return failure_; }  ///< the last one; empty: none
  std::size_t bytes() const noexcept;

 private:
  struct Body;
  struct Made {
    std::shared_ptr<const Body> body;
    std::shared_ptr<ToldSurface> surface;
  };
  void begin_next(std::span<const Tool> tools, const Tissue& tissue);
  void begin_body(const Tissue& tissue);
  void begin_surface(std::span<const Tool> tools, const Tissue& tissue);
  template <class Make>
  void begin(int steps, Make make);
  bool is_due(bool waits) const;
  void end();
  void put_off(const std::exception& failure);
  Vec3 expected_place(const Tool& tool) const;

  Scene scene_;
  Surface surface_;  // without triangles
  std::vector<int> fixed_;
  double period_;                                        // s, of a step
  int calm_steps_, body_steps_, surface_steps_;          // before it begins; until either is in use
  long step_ = 0, due_ = 0, last_cut_, not_before_ = 0;  // of all; when the background has its time; ...
  int failures_ = 0;                                     // in a row
  bool in_vain_ = false;                                 // what is being made: tissue was cut since
  std::uint32_t models_ = 0;                             // so far
  std::string failure_;
  std::shared_ptr<const Body> body_;    // of what is left; null: to be made
  std::shared_ptr<const Body> before_;  // where that is to be made: of what was left before the last cut
  std::shared_ptr<ToldSurface> told_;
  std::future<Made> work_;
};

}  // namespace palpate::sim
