#pragma once
/// Every deformation model with every law and solver it takes, and what else a scene can ask of it; and what
/// is not asked of some of them.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "sim_server/models/deformation_models.h"
#include "sim_server/models/hybrid.h"
#include "sim_server/models/implicit.h"
#include "sim_server/models/reduced.h"

namespace palpate::test {

constexpr int kRestModes = 8;

/// A row of the registry, with what a scene asks of it.
struct ModelCase {
  using Solver = sim::DynamicsSettings::Solver;
  const sim::DeformationModelRow& row;
  sim::ElasticLaw law = sim::ElasticLaw::kLinear;
  Solver solver = Solver::kDirect;
  sim::ElementKind element = sim::ElementKind::kLinear;
  bool fibres = false, relaxes = false, second_order = false;

  bool linear() const { return law == sim::ElasticLaw::kLinear; }
  /// "implicit", "corotational", "p2": the model and its law, then what is not usual.
  std::vector<std::string_view> words() const {
    constexpr std::array kLaws{"linear", "corotational", "stvk", "neo-Hookean"};
    constexpr std::array kElements{"p1", "nodal pressure", "p2"};
    constexpr std::array kSolvers{"direct", "quasi-Newton"};
    std::vector<std::string_view> words{row.name, kLaws[static_cast<std::size_t>(law)]};
    if (element != sim::ElementKind::kLinear) words.push_back(kElements[static_cast<std::size_t>(element)]);
    if (solver != Solver::kDirect) words.push_back(kSolvers[static_cast<std::size_t>(solver)]);
    if (fibres) words.push_back("fibres");
    if (relaxes) words.push_back("relaxation");
    if (second_order) words.push_back("BDF2");
    return words;
  }
  std::string name() const {
    std::string name;
    for (const std::string_view word : words()) name += (name.empty() ? "" : ", ") + std::string(word);
    return name;
  }
  /// Of its name; or "no linear law".
  bool has(std::string_view word) const {
    const auto all = words();
    return word == "no linear law" ? !linear() : std::ranges::find(all, word) != all.end();
  }
  /// Writes the choice into a scene, and has iterations go on until rounding ends them. Where it moves only
  /// what can be cut, that is what lies beyond z = 0.
  void choose(sim::Scene& scene) const {
    scene.deformation.model = row.name;
    scene.material->law = law;
    scene.material->element = element;
    if (fibres) scene.material->fibres = sim::Fibres{Vec3(1, 0.5, 2).normalized(), 1.2e4};
    if (relaxes) scene.material->relaxations = {{0.3, 0.02}, {0.1, 0.008}};
    scene.deformation.of<sim::ImplicitSettings>().second_order = second_order;
    scene.deformation.of<sim::ImplicitSettings>().solver = solver;
    scene.deformation.of<sim::ImplicitSettings>().refresh_steps = 2;
    scene.deformation.of<sim::ReducedSettings>().modes = 8;
    scene.deformation.of<sim::HybridSettings>() = {.condensed_modes = kRestModes, .layers = 0};
    if (row.needs_cutting)
      scene.cutting = sim::Cutting{.region = sim::Region{.box = sim::Box{Vec3(-1, -1, 0), Vec3(1, 1, 1)}}};
    scene.deformation.of<sim::ImplicitSettings>().tolerance = 1e-11;
    scene.deformation.of<sim::ImplicitSettings>().max_newton = 60;
  }
};

/// What physics, or its method, does not let a model do: all of its cases, or those with all these words.
struct Exemption {
  std::string_view model;
  std::vector<std::string_view> with;
  std::string_view from, reason;
};
inline const std::vector<Exemption> kExemptions{
    {"rigid", {}, "static limit", "it does not deform"},
    {"rigid", {}, "elastic energy", "it does not deform"},
    {"spring", {}, "static limit", "the organ moves as one piece, not as its [material] says"},
    {"spring", {}, "elastic energy", "what it stores is in the spring, not in the [material]"},
    {"spring", {}, "turning", "the axes of `spring_stiffness` are the world's"},
    {"implicit", {}, "no allocation", "it factors matrices as it goes"},
    {"implicit", {"no linear law"}, "slope in motion", "its factor is of where the body was before"},
    {"tensor_mass", {}, "energy in one place", "leapfrog keeps that between two places"},
    {"implicit", {"BDF2"}, "energy step by step", "what it does not raise is of two steps together"},
    {"hybrid", {}, "energy in motion", "what its rest does besides its modes has no inertia"},
    {"hybrid", {}, "tangents", "contact gives way over a sub-step, so that it tells clients none"},
    {"reduced", {}, "energy step by step", "exact in time, so that differences do not tell velocities"},
    {"implicit", {"stvk"}, "deep press", "its law softens under pressure, and collapses under so much"},
};
inline bool exempt(const ModelCase& choice, std::string_view from) {
  return std::ranges::any_of(kExemptions, [&](const Exemption& e) {
    return e.model == choice.row.name && e.from == from &&
           std::ranges::all_of(e.with, [&](std::string_view word) { return choice.has(word); });
  });
}

/// How long (steps) loads are to be held until compliance is of here and now.
inline int held_until_fresh(const ModelCase& choice) {
  return exempt(choice, "slope in motion") ? 60 : 0;
}

/// One case for each thing that a row takes.
inline std::vector<ModelCase> model_cases() {
  using sim::ElasticLaw;
  using sim::ElementKind;
  using Solver = ModelCase::Solver;
  std::vector<ModelCase> cases;
  for (const sim::DeformationModelRow& row : sim::deformation_models()) {
    cases.push_back({row});
    if (row.materials == sim::Materials::kLinear) {
      cases.push_back({.row = row, .element = ElementKind::kQuadratic});
      cases.push_back({.row = row, .element = ElementKind::kNodalPressure});
      cases.push_back({.row = row, .fibres = true});
    }
    if (row.materials != sim::Materials::kAny) continue;
    for (const ElasticLaw law :
         {ElasticLaw::kCorotational, ElasticLaw::kStVenantKirchhoff, ElasticLaw::kNeoHookean})
      cases.push_back({row, law});
    cases.push_back({row, ElasticLaw::kCorotational, Solver::kQuasiNewton});
    cases.push_back({.row = row, .law = ElasticLaw::kCorotational, .element = ElementKind::kQuadratic});
    cases.push_back({.row = row, .law = ElasticLaw::kNeoHookean, .element = ElementKind::kNodalPressure});
    cases.push_back({.row = row, .law = ElasticLaw::kCorotational, .fibres = true});
    cases.push_back({.row = row, .relaxes = true});
    cases.push_back({.row = row, .law = ElasticLaw::kNeoHookean, .relaxes = true});
    cases.push_back({.row = row, .law = ElasticLaw::kCorotational, .second_order = true});
  }
  return cases;
}

/// Those of them that are `requested`.
template <class Requested>
std::vector<ModelCase> model_cases(const Requested& requested) {
  std::vector<ModelCase> cases;
  for (const ModelCase& one : model_cases()) {
    if (requested(one)) cases.push_back(one);
  }
  return cases;
}

}  // namespace palpate::test
