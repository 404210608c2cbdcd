// How the settings of the model "implicit" are read and written: parts of ImplicitSettings.
#include <algorithm>
#include <array>
#include <fmt/core.h>

#include "common/error.h"
#include "common/text.h"
#include "sim_server/models/implicit.h"
#include "sim_server/tissue/rayleigh_damping.h"

namespace palpate::sim {
namespace {

struct NamedSolver {
  std::string_view name;
  DynamicsSettings::Solver value;
};
constexpr std::array kSolvers{
    NamedSolver{"direct", DynamicsSettings::Solver::kDirect},
    NamedSolver{"quasi_newton", DynamicsSettings::Solver::kQuasiNewton},
};

}  // namespace

ImplicitSettings ImplicitSettings::read(const Config& config) {
  ImplicitSettings settings;
  const std::string integrator = config.text("integrator", "backward_euler");
  settings.second_order = integrator == "bdf2";
  if (!settings.second_order && integrator != "backward_euler")
    fail("{}: unknown integrator \"{}\"; known: backward_euler, bdf2", config.where("integrator"),
         integrator);
  settings.solver =
      find_row(kSolvers, config.text("solver", "direct"), "solver", config.where("solver")).value;
  settings.refresh_steps =
      static_cast<int>(config.integer("refresh_steps", {1, 1000, "steps"}, settings.refresh_steps));
  if (settings.solver == DynamicsSettings::Solver::kDirect && config.says("refresh_steps"))
    fail("{}: solver \"direct\" factors where it has to; refresh_steps is for quasi_newton",
         config.where("refresh_steps"));
  settings.max_newton =
      static_cast<int>(config.integer("max_newton", {1, 100, "per step"}, settings.max_newton));
  settings.tolerance = config.number("tolerance", {1e-12, 0.1, "of the forces"}, settings.tolerance);
  return settings;
}

std::string ImplicitSettings::to_text() const {
  std::string text;
  if (second_order) text += "integrator = \"bdf2\"\n";
  const auto row = std::ranges::find_if(kSolvers, [this](const NamedSolver& s) { return s.value == solver; });
  text += fmt::format("solver = \"{}\"\n", row->name);
  if (solver != DynamicsSettings::Solver::kDirect) text += fmt::format("refresh_steps = {}\n", refresh_steps);
  return text + fmt::format("tolerance = {:g}\nmax_newton = {}\n", tolerance, max_newton);
}

DynamicsSettings dynamics_settings(const DeformationSettings& settings) {
  const auto& damping = settings.of<RayleighDamping>();
  const auto& steps = settings.of<ImplicitSettings>();
  return {.rayleigh_mass = damping.mass,
          .rayleigh_stiffness = damping.stiffness,
          .second_order = steps.second_order,
          .solver = steps.solver,
          .refresh_steps = steps.refresh_steps,
          .tolerance = steps.column_tolerance()};
}

}  // namespace palpate::sim
