#pragma once
#include <span>
#include <vector>

#include "common/prompt_team.h"
#include "sim_server/elasticity/floating_pieces.h"
#include "sim_server/elasticity/tensors.h"
#include "sim_server/scene/scene.h"
#include "sim_server/tissue/rayleigh_damping.h"

namespace palpate::sim {

/// The highest angular frequency of M^-1 K, rad/s, from below: the power method from a fixed start until the
/// Rayleigh quotient grows by less than one in a million, or 1000 products.
double highest_frequency(const ElasticTensors& tensors);

/// The longest sub-step (s) that is stable where no frequency is above `w` (rad/s). From the roots of one
/// mode's step, h^2 w^2 + 2 h d <= 4 with d = mass + stiffness w^2; without damping that is h <= 2 / w.
double longest_sub_step(double w, const RayleighDamping& damping);

/// Returns how many sub-steps of at most `longest` (s) make a step of the scene. Throws `Error` where it
/// names no rate, or where no step of so many could be in time.
double count_sub_steps(const Scene& scene, double longest);

/// The free vertices of a linear tissue in motion, by the semi-implicit (symplectic) Euler method with
/// lumped masses M:
///   v += h (M^-1 (f - K (u + stiffness v)) - mass v),   u += h v.
/// K acts on pieces that nothing holds in the floating frame of each (`FloatingPieces`).
/// Several motions side by side: (n x 3 x columns), those of one number together. One motion of a large body
/// goes on by all cores, with the same bits whatever their number. Only the constructor allocates, and the
/// first sub-step of a large body, which starts the threads of the other cores (`PromptTeam`).
class ExplicitMotion {
 public:
  /// Starts at rest. `columns`: 1 or `ElasticTensors::kWide`. `tensors` must outlive it. `most_threads`: of
  /// one motion, go on by so many at most; 0: by as many as there are cores.
  ExplicitMotion(const ElasticTensors& tensors, const RayleighDamping& damping, int columns = 1,
                 int most_threads = 0);

  /// Displacements, m; velocities, m/s, half a sub-step before them; the forces held until now, N.
  struct State {
    std::vector<double> u, v, f;
  };
  State state;

  /// Goes on by `steps` >= 1 sub-steps of `h` (s) under forces (N) that are held. The first takes the mean of
  /// those before and these, so that they change half-way between two velocities. The displacement is then of
  /// second order in h, of each mode never against its force, and forces that stay give no jolt.
  void run(int steps, double h, const std::vector<double>& force) noexcept;
  /// Advances by one sub-step under the forces of `state`, as if they had always acted.
  void run(double h) noexcept;
  /// Advances by one sub-step where only `add_impulse` has changed `state` since the last one.
  void run_on(double h) noexcept { sub_step(h, state.f); }
  /// Changes the velocity of a vertex by `dv` (m/s), as if that had been so over the last sub-step, of `h`
  /// (s). Of one motion.
  void add_impulse(int place, double h, const Vec3& dv) noexcept;
  /// Other cores begin the product K (u + stiffness v) of the next sub-step: until that, nothing but kicks
  /// changes the motion, and what these add to the product is added after it. Of large bodies alone, with the
  /// same bits whatever the number of threads.
  void start_next() noexcept;
  /// Drops the product that has begun: the motion, or its tensors, may then be changed in any way.
  void drop_next() noexcept;
  /// Goes on by one sub-step without forces, and leaves where it was in `before`, a state of this size.
  /// Nothing but `add_to_last` may have changed `state` since it was at rest or the last sub-step ended. Of
  /// one motion.
  void run_free(State& before, double h) noexcept;
  /// Adds a force (N) on one vertex to those of the last sub-step, which was of `h` (s): it has moved nothing
  /// else yet. Of one motion.
  void add_to_last(int place, double h, const Vec3& force) noexcept;

  /// Lets these pieces float, by places; each other vertex is held with the rest. `run` is the next step. Of
  /// one motion. Allocates.
  void release(FloatingPieces pieces);
  /// Pieces that float, and their frames, as the next sub-step takes them.
  const FloatingPieces& floating() const { return floating_; }
  std::span<const FloatingPieces::Frame> frames() const { return frames_; }
  /// Finds the frames where the state was changed by anything but sub-steps and impulses.
  void find_frames() noexcept;
  /// Turns forces on the vertices of floating pieces (N, 3 x places), each in the frame of its piece and
  /// linear in the displacements there, as K (u + stiffness v) is turned. Of one motion.
  void turn_forces(std::span<double> forces) const noexcept {
    floating_.turn_forces(frames_, {state.u.data()}, {forces.data()});
  }
  /// Returns the displacement of a vertex, of a floating piece in its frame, m.
  Vec3 turned_displacement(int place) const;

  /// State of the motion as a value.
  struct Snapshot {
    State state;
    std::vector<double> bent, resistance;
    ElasticTensors::Ahead ahead;
    std::vector<std::pair<int, Vec3>> kicks;
    bool begun = false;
    FloatingPieces floating;
    std::vector<FloatingPieces::Frame> frames;
  };
  /// Waits for a product that has begun; `restore` continues with it. Of one motion. Allocates.
  Snapshot save();
  void restore(const Snapshot& saved);

  /// The tensors have one more vertex, the last one: it is where this one is, as fast. Nothing is begun. Of
  /// one motion. Allocates.
  void append_copy_of(int place);

  std::size_t bytes() const {
    return (3 * state.u.size() + 2 * bent_.size()) * sizeof(double) + kicks_.capacity() * sizeof(Impulse) +
           floating_.bytes();
  }

 private:
  /// A place and how far a kick moves the vector whose product has begun there, m.
  using Impulse = std::pair<int, Vec3>;
  /// The product, of one part.
  struct MultiplyPart {
    ExplicitMotion& of;
    void operator()(std::uint32_t part) const noexcept;
  };

  template <class Work>
  void for_parts(const Work& work) noexcept;
  void multiply() noexcept;
  void sub_step(double h, const std::vector<double>& force) noexcept;
  void sub_step_floating(double h, const std::vector<double>& force) noexcept;
  void turn_bent() noexcept;
  template <int kColumns>
  void advance(std::size_t begin, std::size_t end, double h, const double* force) noexcept;

  const ElasticTensors& tensors_;
  RayleighDamping damping_;
  int columns_;
  /// Returns the stride between vertices in the two vectors below.
  std::size_t numbers_per_vertex() const {
    return columns_ == 1 ? ElasticTensors::kNumbersPerVertex : 3 * static_cast<std::size_t>(columns_);
  }
  void bend(std::size_t begin, std::size_t end) noexcept;

  std::vector<double> bent_, resistance_;  // u + stiffness v, m; K times that, N
  ElasticTensors::Ahead ahead_;            // of that product, of one motion
  FloatingPieces floating_;
  std::vector<FloatingPieces::Frame> frames_;  // of these, in which `bent_` of their vertices is
  MultiplyPart multiply_part_{*this};
  bool begun_ = false;          // the product of the next sub-step, of where the last one led
  std::vector<Impulse> kicks_;  // since then
  PromptTeam team_;             // ends first: helpers use the others
};

}  // namespace palpate::sim
