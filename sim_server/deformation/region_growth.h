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
/// comes `after` seconds later, at any speed of the machine: that step waits for it. So the same tool makes
/// the same bits, unless memory ends: then what can be cut stays as it is, and the same is tried again after
/// that time, doubled at each failure in a row. Owned by the thread that steps. Destroying it waits for the
/// background.
class RegionGrowth {
 public:
  /// `mass_factors`: of tetrahedra. `highest`: rad/s, of modes of the rest. The mesh outlives this. Of a
  /// scene with [cutting.growth]. Throws `Error` where nothing could grow.
  RegionGrowth(const ModelInputs& inputs, RegionInMotion region, std::vector<double> mass_factors,
               double highest);

  /// These were removed.
  void note_removed(std::span<const int> tetrahedra);

  /// A body that takes over.
  struct Grown {
    std::unique_ptr<CuttableBody> body;   ///< of what was left when it was begun
    std::unique_ptr<HandOver> hand_over;  ///< to it
    std::vector<int> allowed;             ///< tetrahedra that can be removed from now on
    std::vector<int> removed_since;       ///< and those that were removed since it was begun
  };
  struct Step {
    bool begun = false;          ///< the background begins
    std::optional<Grown> grown;  ///< it has ended, and this takes over
    std::string failure;         ///< it has ended, and what can be cut stays as it is; why
  };
  /// A step begins. `now`: the body that is in use. Waits for the background where its time has come.
  Step step(const CuttableBody& now, const CutMesh& left);

  std::size_t bytes() const;

 private:
  /// What a body is made of.
  struct Inputs {
    Scene scene;
    const TetMesh& mesh;
    Surface surface;
    std::vector<int> fixed, reachable;
  };
  /// What the background makes.
  struct Made {
    Grown grown;
    RegionInMotion region;
    std::vector<int> near_end;
  };
  void begin(std::vector<int> allowed, const CuttableBody& now, const CutMesh& left);
  Step end();
  std::vector<int> near_seeds(const CutMesh& left) const;

  Inputs inputs_;
  RegionInMotion region_;
  std::vector<double> mass_factors_;
  double highest_;
  long steps_, step_ = 0, due_ = 0;  // from begin to end; of all; when the background has its time
  long not_before_ = 0;              // the next begins
  int failures_ = 0;                 // in a row
  std::vector<int> near_end_;        // of each tetrahedron: a vertex at the end of what can be cut, or -1
  std::vector<int> seeds_;           // such vertices, where a cut has come near
  std::vector<int> removed_since_;   // the background began
  std::future<Made> work_;
};

}  // namespace palpate::sim
