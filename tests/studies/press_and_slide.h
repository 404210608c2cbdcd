#pragma once
#include <map>
#include <memory>
#include <vector>

#include "sim_server/serving/served_tools.h"
#include "sim_server/serving/surface_pager.h"
#include "tests/studies/hands.h"

namespace palpate::studies {

/// A hand presses a sphere of 6 mm radius with 1.5 N on a soft block of finite elements (60 x 24 x 40 mm, nu
/// 0.45, edges of 2 mm under the path, held at the bottom) and slides it to and fro by 6 mm, in closed loop
/// with the server's own simulation, whose answers travel as they are. Unstable is a loop whose motion above
/// about 5 Hz is more than three times that of the direct one, and 30 um. The tissue is at rest
/// (`quasi_static`), or swings (`reduced`, 30 times as heavy as tissue, so that a hand feels it: its
/// slowest modes are those of 8 to 30 Hz); then the link has 30 steps a second. For one thread: it keeps the
/// blocks it has built.
class PressAndSlide {
 public:
  static constexpr const char *kRests = "press_and_slide", *kSwings = "press_and_slide_swinging";  // worlds
  /// Whether this build has the model of a world.
  static bool has(const std::string& world);

  /// Stiffnesses tried: slope of the force on the sphere at 1.5 N, N/m.
  static const std::vector<double>& stiffnesses();

  /// Whether that is stable; the force error only if it is to `compare`, which takes longer, of tissue at
  /// rest.
  Outcome run(const Cell& cell, double stiffness, int seed, bool compare);
  /// The stiffest of `stiffnesses()` up to which all seeds are stable; 0: none.
  double threshold(const Cell& cell);

 private:
  struct Block;
  using Which = std::pair<std::string, double>;  // world, stiffness
  Block& block_of(const Which& which);
  double direct_motion(const Person& person, const Which& which);

  std::map<Which, std::shared_ptr<Block>> blocks_;
  std::map<std::pair<const Person*, Which>, double> direct_;  // m, RMS, of the first seed
};

}  // namespace palpate::studies
