#include "sim_server/statics/compliance_tolerance.h"

#include <cmath>
#include <fmt/core.h>

#include "common/error.h"

namespace palpate::sim {

ComplianceTolerance ComplianceTolerance::read(const Config& config) {
  constexpr double kLeast = 1e-6;  // of single precision, in which tiles are kept
  ComplianceTolerance read;
  if (!config.says("compliance_tolerance")) return read;
  read.relative = config.number("compliance_tolerance", {0, 1e-2, "of the compliance of a node"});
  if (*read.relative > 0 && *read.relative < kLeast)
    fail(
        "{}: `compliance_tolerance` = {:g}: must be 0, for a dense matrix in double precision, or 1e-06 or "
        "more",
        config.where("compliance_tolerance"), *read.relative);
  return read;
}

std::string ComplianceTolerance::to_text() const {
  return relative ? fmt::format("compliance_tolerance = {:g}\n", *relative) : "";
}

double ComplianceTolerance::of(std::size_t nodes) const {
  constexpr std::size_t kManyNodes = 2000;  // a dense matrix of 290 MB
  constexpr double kUsual = 1e-4;           // tiles of 2562 nodes take 39 MB instead of 473
  return relative.value_or(nodes <= kManyNodes ? 0 : kUsual);
}

double ComplianceTolerance::bytes(std::size_t nodes) const {
  const auto r = static_cast<double>(nodes);
  constexpr double kPair = 9 * sizeof(double);  // bytes of a 3 x 3 block
  return of(nodes) == 0 ? kPair * r * r : -175 * std::log10(of(nodes)) * std::pow(r, 1.4);
}

}  // namespace palpate::sim
