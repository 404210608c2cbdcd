#include "sim_server/tissue/rayleigh_damping.h"

#include <fmt/core.h>

namespace palpate::sim {

RayleighDamping RayleighDamping::read(const Config& config) {
  RayleighDamping damping;
  damping.mass = config.number("rayleigh_mass", {0, 1e4, "1/s"}, damping.mass);
  damping.stiffness = config.number("rayleigh_stiffness", {0, 1, "s"}, damping.stiffness);
  return damping;
}

std::string RayleighDamping::to_text() const {
  return fmt::format("rayleigh_mass = {:g}\nrayleigh_stiffness = {:g}\n", mass, stiffness);
}

}  // namespace palpate::sim
