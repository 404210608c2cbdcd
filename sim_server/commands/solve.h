#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/program.h"

namespace palpate::sim {

/// Options of `sim_server solve`.
struct SolveOptions {
  std::filesystem::path scene, out;
  std::vector<std::string> probes;              ///< "x,y,z", m, in the body at rest
  std::optional<double> seconds;                ///< of motion; absent: the static equilibrium
  double step = 0.01;                           ///< s, of the motion
  std::optional<std::filesystem::path> series;  ///< a .pvd of `frames` files beside it
  int frames = 50;
};

/// Solves a scene without a tool, writes the deformed mesh (`out`, .vtu: displacement m, Cauchy stress Pa,
/// von Mises stress Pa, strain energy density J/m3, volume over that at rest) and prints what an engineer
/// compares: energy, reactions, probes to 9 digits. Throws `Error`. Returns the exit code.
int solve(const SolveOptions& options);

/// `sim_server solve`.
Command solve_command();

}  // namespace palpate::sim
