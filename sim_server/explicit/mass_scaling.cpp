#include "sim_server/explicit/mass_scaling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/core.h>
#include <numeric>

#include "sim_server/elasticity/element.h"
#include "sim_server/elasticity/tensors.h"
#include "sim_server/sparse/blas.h"

namespace palpate::sim {
namespace {

/// The square of the highest angular frequency of a tetrahedron alone, (rad/s)^2.
double squared_frequency(const LinearTetrahedron& element, const Material& material) {
  using Matrix12 = Eigen::Matrix<double, 12, 12>;
  const Moduli moduli = LinearLaw::moduli(material);
  Matrix12 k;  // per volume
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = 0; b < 4; ++b) {
      k.block<3, 3>(3 * static_cast<Eigen::Index>(a), 3 * static_cast<Eigen::Index>(b)) =
          stiffness_per_volume(moduli, element.gradient[a], element.gradient[b]);
    }
  }
  constexpr int kRows = 12, kWork = 3 * kRows;
  std::array<double, kRows> eigenvalues;
  std::array<double, kWork> work;
  int info = 0;  // Eigen's solver takes 14 s to compile
  Blas<double>::syev("N", "L", &kRows, k.data(), &kRows, eigenvalues.data(), work.data(), &kWork, &info);
  return eigenvalues.back() / (material.density / 4);
}

double squared_frequency_in(const TetMesh& mesh, std::size_t tetrahedron, const Material& material) {
  const Tetrahedron& t = mesh.tetrahedra[tetrahedron];
  const auto& x = mesh.vertices;
  const LinearTetrahedron element({x[t[0]], x[t[1]], x[t[2]], x[t[3]]});
  return (mesh.stiffness.empty() ? 1 : mesh.stiffness[tetrahedron]) * squared_frequency(element, material);
}

}  // namespace

AddedMass AddedMass::read(const Config& config) {
  AddedMass read;
  if (config.says("added_mass"))
    read.fraction = config.number("added_mass", {0, 0.2, "of the mass in motion"});
  return read;
}

std::string AddedMass::to_text() const {
  return fraction ? fmt::format("added_mass = {:g}\n", *fraction) : "";
}

std::string added_mass_text(double fraction) {
  return fmt::format(
      "{:.2g} % more mass in motion, at its stiffest elements, saves sub-steps: a force at rest is the same, "
      "one of tissue that moves fast is late by its inertia; `[deformation] added_mass = 0` gives it without",
      100 * fraction);
}

double mass_factor_of(const TetMesh& mesh, std::size_t tetrahedron, const Material& material,
                      double frequency) {
  return std::max(1.0, squared_frequency_in(mesh, tetrahedron, material) / (frequency * frequency));
}

MassScaling scale_masses(const TetMesh& mesh, const Material& material, double fraction,
                         std::span<const char> moves) {
  const auto is_in_motion = [&](int v) { return moves.empty() || moves[static_cast<std::size_t>(v)] != 0; };
  std::vector<double> squares, masses;  // of each element: (rad/s)^2, kg
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const Tetrahedron& t = mesh.tetrahedra[e];
    if (std::ranges::none_of(t, is_in_motion)) {
      squares.push_back(0);
      masses.push_back(0);
      continue;
    }
    squares.push_back(squared_frequency_in(mesh, e, material));
    masses.push_back(material.density * six_volumes(mesh, t) / 6);
  }
  std::vector<std::size_t> order(squares.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return squares[a] > squares[b]; });
  const double in_motion = std::accumulate(masses.begin(), masses.end(), 0.0), most = fraction * in_motion;
  MassScaling scaling{.factors = std::vector<double>(squares.size(), 1)};
  // With all above the square w of some element lowered to it, sum m_e (w_e / w - 1) is added.
  double weighted = 0, mass = 0, bound = squares[order.front()];
  for (const std::size_t e : order) {
    if (weighted / squares[e] - mass > most) break;
    bound = squares[e];
    weighted += masses[e] * squares[e];
    mass += masses[e];
  }
  for (std::size_t e = 0; e < squares.size(); ++e) {
    if (squares[e] <= bound) continue;
    scaling.factors[e] = squares[e] / bound;
    scaling.added += (scaling.factors[e] - 1) * masses[e];
  }
  scaling.fraction = in_motion > 0 ? scaling.added / in_motion : 0;
  scaling.frequency = std::sqrt(bound);
  return scaling;
}

}  // namespace palpate::sim
