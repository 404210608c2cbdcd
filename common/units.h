#pragma once
#include <numbers>

namespace palpate {

/// Radians in a degree.
constexpr double kDegree = std::numbers::pi / 180;

/// Largest coordinate of a place in the world, m. It is far beyond any room, so a larger one is wrong input.
constexpr double kMaxCoordinate = 1e3;

}  // namespace palpate
