#pragma once
#include <cstdint>

namespace palpate {

/// Source of a figure for an error. On the wire; the numbers never change.
enum class ErrorSource : std::uint8_t {
  kUnknown = 0,    ///< nobody knows how large it is
  kEstimated = 1,  ///< by a table, or by presses before the first step
  kMeasured = 2,   ///< by a study of this very scene
  kNone = 3,       ///< the method makes no such error
};

/// Error of a force, % of its root mean square; 0 where it is unknown.
struct DiscretisationError {
  ErrorSource source = ErrorSource::kUnknown;
  float percent = 0;

  bool known() const noexcept { return source != ErrorSource::kUnknown; }
};

/// Errors of the force on a tool by the mesh of a tissue, and by its time step.
struct DiscretisationErrors {
  DiscretisationError mesh{}, time_step{};
};

constexpr const char* name_of(ErrorSource source) noexcept {
  switch (source) {
    case ErrorSource::kUnknown:
      return "unknown";
    case ErrorSource::kEstimated:
      return "estimated";
    case ErrorSource::kMeasured:
      return "measured by a study";
    case ErrorSource::kNone:
      return "none by construction";
  }
  return "unknown";
}

}  // namespace palpate
