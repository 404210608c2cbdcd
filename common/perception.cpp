#include "common/perception.h"

#include <fmt/format.h>

namespace palpate {

std::string beside_the_hand(double age_ms, const std::string& which) {
  const char* const late = age_ms < kNoticedInDamper   ? "late in neither"
                           : age_ms < kNoticedInSpring ? "late in a damper"
                                                       : "late in both";
  return fmt::format(
      "a hand can tell {:g} % of a force, {:g} % of a modulus, and a delay of {:g} ms in a damper, {:g} ms "
      "in a spring; this force is {:.0f} ms old{}: {}",
      100 * kNoticedForce, 100 * kNoticedModulus, kNoticedInDamper, kNoticedInSpring, age_ms, which, late);
}

}  // namespace palpate
