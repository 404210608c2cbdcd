#pragma once
#include <array>
#include <cstdint>
#include <string_view>

namespace palpate {

/// Why a force is flagged: no settled answer stands behind it.
enum class Doubt : std::uint8_t {
  kFailed,
  kRanAway,
  kInsideOut,
  kNotBalanced,
  kTools,
  kContact,
  kOutsideReach
};

/// Reasons in the words of messages, after "the force is not settled: ".
inline constexpr std::array<std::string_view, 7> kDoubtTexts{
    "a step of the simulation failed",
    "the organ ran away",
    "tissue is turned inside out",
    "the tissue found no balance",
    "the tools did not settle together",
    "contact did not settle",
    "the tool is inside the organ, outside its [[tool]] reach"};

}  // namespace palpate
