#pragma once
#include <cstdint>
#include <string>

#include "common/report.h"
#include "sim_server/elasticity/material.h"

namespace palpate::sim {

/// Returns up to which strain (change of length by length at rest) a law is meant. The linear law and the
/// corotational one take strain for small: at 0.2, (l / l0)^2 / 2 - 1/2 differs from l / l0 - 1 by 10 %, as
/// much of a force as a hand can tell. St. Venant and Kirchhoff's softens in compression from l / l0 = 1 /
/// sqrt(3) on, where the force l / l0 ((l / l0)^2 - 1) has its extremum. Neo-Hookean rubber elasticity holds
/// to a stretch of about 1.5 (Treloar 1944, Trans. Faraday Soc. 40:59, figure 1).
double meant_strain(ElasticLaw law) noexcept;

/// Strain of the surface where tools press, over a run, against what the law of the tissue is meant for.
class StrainRange {
 public:
  explicit StrainRange(ElasticLaw law) : law_(law) {}
  /// Notes the strain of a step in contact; returns true if it is beyond what the law is meant for.
  bool add(double strain) noexcept;
  /// True if tissue of the linear law is inside out under a tool: a face of the surface is turned over, its
  /// `area` (`ToolContact::least_area`) being 0 or less, or its `strain` is beyond 3, as where a tip came out
  /// behind. That law resists neither. False of other laws: elements tell (`NonlinearModel::balance`).
  bool is_inside_out(double strain, double area) const noexcept;
  /// "strain up to 45 % where tools press, in 12 of 80 steps in contact beyond the 20 % that ..."; empty:
  /// none was.
  std::string to_text() const;
  /// {"largest": ..., "meant": ..., "steps": ..., "beyond_steps": ...}.
  Json to_json() const;

 private:
  ElasticLaw law_;
  std::uint64_t steps_ = 0, beyond_ = 0;
  double largest_ = 0;
};

}  // namespace palpate::sim
