#pragma once
#include <future>
#include <memory>
#include <string>

#include "sim_server/deformation/hand_over.h"
#include "sim_server/deformation/region_in_motion.h"

namespace palpate::sim {

/// What can be cut of a body, and with it what is in motion, follows the cut ([cutting.growth]). Where a cut
/// comes within half of `reach` of the end of what can be cut, the body that has all within `reach` of there
/// in motion, too, is made in the background, while the one before goes on. It takes over in the step that
/// comes `after` seconds later, at any speed of the machine: a step that `waits` waits for it then, so that
/// the same tool makes the same bits; one that does not goes on without, and it takes over in the first that
/// finds it made. Where memory ends, what can be cut stays as it is, and the same is tried again after that
/// time, doubled at each failure in a row. Owned by the thread that steps. Destroying it waits for the
/// background.
class RegionGrowth {
 public:
  /// `highest`: rad/s, of modes of the rest. The mesh outlives this. Of a scene with [cutting.growth]. Throws
  /// `Error` where nothing could grow.
  RegionGrowth(const ModelInputs& inputs, RegionInMotion region, double highest);

  /// These were removed.
  void note_removed(std::span<const int> tetrahedra);
  /// These slid, and faces were parted.
  void note_parted(std::span<const DeformationModel::Slide> slides, const Parting& parting);

  /// What happened to the mesh in some time, in whatever order.
  struct Cuts {
    std::vector<int> removed, slid;  ///< tetrahedra; vertices
    Parting parting;                 ///< all of it in one
  };
  /// A body that takes over.
  struct Grown {
    std::unique_ptr<CuttableBody> body;   ///< of what was left when it was begun
    std::unique_ptr<HandOver> hand_over;  ///< to it
    std::vector<int> allowed;             ///< tetrahedra that can be removed from now on
    Cuts since;                           ///< it was begun
  };
  struct Step {
    bool begun = false;               ///< the background begins
    bool late = false;                ///< its time has come, and it is still at it
    std::optional<Grown> grown = {};  ///< it has ended, and this takes over
    std::string failure = {};  ///< it has ended, or could not begin: what can be cut stays as it is; why
  };
  /// A step begins. `now`: the body that is in use. `waits`: for the background where its time has come.
  Step step(const CuttableBody& now, const CutMesh& left, bool waits);

  std::size_t bytes() const;

 private:
  /// What a body is made of.
  struct Inputs {
    Scene scene;
    const TetMesh& mesh;
    Surface surface;
    std::vector<int> fixed, reachable;
  };
  /// What the background begins with, of its own.
  struct Begun {
    TetMesh mesh;
    CutMesh left;             // of the mesh that steps go on with
    std::vector<int> places;  // of vertices, in the motion of now
    std::vector<double> mass_factors;
    RegionInMotion region;
    std::vector<int> allowed;
  };
  /// What the background makes.
  struct Made {
    Grown grown;
    RegionInMotion region;
    std::vector<int> near_end;
  };
  void begin(std::vector<int> allowed, const CuttableBody& now, const CutMesh& left);
  Made make(Begun begun, const CuttableBody& now) const;
  void note_seeds(std::span<const int> tetrahedra);
  Step end();
  void put_off(const std::exception& error, Step& step);
  std::vector<int> near_seeds(const CutMesh& left) const;

  Inputs inputs_;
  RegionInMotion region_;
  double highest_;
  long steps_, step_ = 0, due_ = 0;  // from begin to end; of all; when the background has its time
  long not_before_ = 0;              // the next begins
  int failures_ = 0;                 // in a row
  std::vector<int> near_end_;        // of each tetrahedron: a vertex at the end of what can be cut, or -1
  std::vector<int> seeds_;           // such vertices, where a cut has come near
  Cuts since_;                       // the background began
  std::future<Made> work_;
};

}  // namespace palpate::sim
