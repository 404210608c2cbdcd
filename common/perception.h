#pragma once
#include <string>

namespace palpate {

/// Smallest differences and delays of a force that a hand notices: of force (Jones 1989: 7 to 10 %), of
/// Young's modulus under a finger (Bergmann Tiest and Kappers 2009), and from when a force is felt to be late
/// (Rank, Shi, Mueller and Hirche), ms.
inline constexpr double kNoticedForce = 0.1, kNoticedModulus = 0.15;
inline constexpr double kNoticedInDamper = 15, kNoticedInSpring = 36;

/// Returns one sentence for reports and pages: what a hand can tell, and where a force of this age (ms) is
/// felt to be late. `which`: of the age, in brackets behind it, such as " (p99)".
std::string beside_the_hand(double age_ms, const std::string& which = "");

}  // namespace palpate
