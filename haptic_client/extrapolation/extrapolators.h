#pragma once
#include <memory>
#include <span>
#include <string_view>

#include "haptic_client/extrapolation/extrapolator.h"

namespace palpate::client {

/// Row of a law: a new law is one file and one row, and passes tests/contract unchanged.
struct ExtrapolatorRow {
  std::string_view name;
  std::string_view summary;
  std::unique_ptr<Extrapolator> (*make)();
  bool exact = true;     ///< gives the sample's force at the sample's place and time
  bool chooses = false;  ///< among other rows: it is always one of them that is at work
};
std::span<const ExtrapolatorRow> extrapolators();

}  // namespace palpate::client
