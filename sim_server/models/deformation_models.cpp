#include "sim_server/models/deformation_models.h"

#include <algorithm>
#include <array>
#include <fmt/core.h>
#include <iterator>

#include "common/error.h"
#include "common/text.h"
#include "sim_server/explicit/mass_scaling.h"
#include "sim_server/models/hybrid.h"
#include "sim_server/models/implicit.h"
#include "sim_server/models/quasi_static.h"
#include "sim_server/models/reduced.h"
#include "sim_server/models/rigid.h"
#include "sim_server/models/spring.h"
#include "sim_server/models/tensor_mass.h"
#include "sim_server/statics/compliance_tolerance.h"
#include "sim_server/tissue/contact_instants.h"

namespace palpate::sim {
namespace {

template <class Settings>
std::string body_text(const Settings& settings) {
  if constexpr (requires { Settings::kOfBody; }) return settings.to_text();
  return {};
}

/// `row` with what the class of a model and its settings do. `Settings`: structs with `kKeys`, `read` and
/// `to_text`.
template <class Model, class... Settings>
constexpr DeformationModelRow row_of(DeformationModelRow row) {
  row.make = [](const ModelInputs& inputs) -> std::unique_ptr<DeformationModel> {
    if constexpr (requires { Model::make(inputs); })
      return Model::make(inputs);
    else
      return std::make_unique<Model>(inputs);
  };
  row.estimated_bytes = &Model::estimated_bytes;
  row.keys = [] {
    std::vector<std::string_view> keys;
    (std::ranges::copy(Settings::kKeys, std::back_inserter(keys)), ...);
    return keys;
  };
  row.read = [](const Config& config, DeformationSettings& settings) {
    ((settings.of<Settings>() = Settings::read(config)), ...);
  };
  row.to_text = [](const DeformationSettings& settings) {
    return (std::string() + ... + settings.of<Settings>().to_text());
  };
  row.body_to_text = [](const DeformationSettings& settings) {
    return (std::string() + ... + body_text(settings.of<Settings>()));
  };
  row.has_settings = []([[maybe_unused]] std::type_index type) {
    return ((type == typeid(Settings)) || ...);
  };
  return row;
}

constexpr std::array kModels{
    row_of<Rigid, RigidSettings>(
        {.name = "rigid", .summary = "no deformation; force = stiffness x penetration depth"}),
    row_of<QuasiStatic, ComplianceTolerance>(
        {.name = "quasi_static",
         .summary = "linear elastic equilibrium by pre-computed compliance",
         .materials = Materials::kLinear,
         .condenses = true}),
    row_of<TensorMass, RayleighDamping, ContactInstants, AddedMass, ClientModes, ComplianceTolerance>(
        {.name = "tensor_mass",
         .summary = "linear elastic motion, explicit, by a tensor per vertex and edge",
         .materials = Materials::kPlain,
         .moves = true,
         .cuts = true,
         .unneeded = {{"factor of the stiffness matrix, kept",
                       "explicit steps solve nothing; set-up lets its own go"}}}),
    row_of<Implicit, RayleighDamping, ImplicitSettings, ContactInstants, ClientModes, ComplianceTolerance>(
        {.name = "implicit",
         .summary = "motion of any law, element and load, by implicit steps",
         .materials = Materials::kAny,
         .moves = true,
         .flies = true,
         .cuts = true}),
    row_of<Reduced, RayleighDamping, ReducedSettings, ContactInstants, ComplianceTolerance>(
        {.name = "reduced",
         .summary = "linear elastic: the slowest modes swing, the rest follows at once",
         .materials = Materials::kLinear,
         .moves = true,
         .condenses = true}),
    row_of<Spring, SpringSettings>({.name = "spring",
                                    .summary = "no deformation; the organ hangs on a spring that hardens",
                                    .moves = true}),
    // Those that need [cutting] are the last.
    row_of<Hybrid, RayleighDamping, ContactInstants, AddedMass, HybridSettings, ClientModes>(
        {.name = "hybrid",
         .summary = "linear elastic: what can be cut in motion as tensor_mass, the rest condensed to its "
                    "slowest modes",
         .materials = Materials::kPlain,
         .moves = true,
         .cuts = true,
         .needs_cutting = true}),
};

bool takes(const DeformationModelRow& row, std::string_view key) {
  return std::ranges::count(row.keys(), key) > 0;
}

void refuse_keys_of_others(const Config& config, const DeformationModelRow& row) {
  for (const DeformationModelRow& other : kModels) {
    for (const std::string_view key : other.keys()) {
      if (takes(row, key) || !config.says(std::string(key))) continue;
      fail("{}: unknown key `[deformation] {}` of model \"{}\"; known to: {}; remove it",
           config.where(std::string(key)), key, row.name,
           models_that([key](const DeformationModelRow& m) { return takes(m, key); }));
    }
  }
}

}  // namespace

std::span<const DeformationModelRow> deformation_models() {
  return kModels;
}

std::span<const DeformationModelRow> models_without_cutting() {
  const auto end = std::ranges::find_if(kModels, &DeformationModelRow::needs_cutting);
  return {kModels.begin(), end};
}

const DeformationModelRow& model_of(const DeformationSettings& settings) {
  return find_row(kModels, settings.model, "deformation model", settings.where);
}

DeformationSettings read_deformation(const Config& config) {
  DeformationSettings settings;
  settings.where = config.where("model");
  settings.model = config.text("model");
  const DeformationModelRow& row = model_of(settings);
  refuse_keys_of_others(config, row);
  row.read(config, settings);
  config.reject_unknown();
  return settings;
}

std::string to_text(const DeformationSettings& settings) {
  return fmt::format("[deformation]\nmodel = \"{}\"\n{}", settings.model,
                     model_of(settings).to_text(settings));
}

}  // namespace palpate::sim
