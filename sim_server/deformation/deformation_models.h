#pragma once
#include <memory>
#include <span>
#include <string_view>

#include "sim_server/deformation/deformation_model.h"
#include "sim_server/deformation/model_inputs.h"

namespace palpate::sim {

/// One row per model: a new one is one file and one row.
struct DeformationModelRow {
  std::string_view name;
  std::string_view summary;
  std::unique_ptr<DeformationModel> (*make)(const ModelInputs&);
  bool elastic = false;           ///< it needs a [material], and keeps the compliance of what tools reach
  bool follows_supports = false;  ///< it moves with a [[fixed.motion]]
  bool any_linear = false;        ///< all elements, and fibres, of the linear law
  bool any_material = false;      ///< all laws, elements, fibres, relaxation, and [[load]]
  bool damped = false;            ///< it has Rayleigh damping
  bool modal = false;             ///< it takes a number of `modes`
  bool penalty = false;           ///< it takes the `stiffness` of a contact
  bool hangs = false;             ///< it takes the `spring_stiffness` of what holds the organ
};
std::span<const DeformationModelRow> deformation_models();

}  // namespace palpate::sim
