#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "common/config.h"

namespace palpate::sim {

/// `[deformation] compliance_tolerance`: how the compliance of a surface is kept (`SurfaceCompliance`).
struct ComplianceTolerance {
  /// [1e-6, 1e-2]: in tiles of low rank, with this error (`BlockLowRankMatrix`); 0: dense, in double
  /// precision. Absent: dense for up to 2000 nodes, else 1e-4.
  std::optional<double> relative{};

  static constexpr std::array<std::string_view, 1> kKeys{"compliance_tolerance"};
  static ComplianceTolerance read(const Config& config);
  std::string to_text() const;
  /// Returns the tolerance for so many nodes; 0: dense.
  double of(std::size_t nodes) const;
  /// Returns the memory of so many nodes, bytes: 72 r^2 where it is dense, else about as much as on three
  /// livers of 2404 to 10 249 nodes (a plate of 18 612 took 15 % more).
  double bytes(std::size_t nodes) const;
};

}  // namespace palpate::sim
