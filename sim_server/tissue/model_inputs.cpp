#include "sim_server/tissue/model_inputs.h"

#include <algorithm>

#include "common/error.h"

namespace palpate::sim {

double held_stiffness(const Scene& scene) {
  constexpr double kLeast = 2000, kOfTissue = 10;  // N/m; no unit
  double radius = 0;
  for (const ToolSettings& tool : scene.tools) radius = std::max(radius, tool.shape.radius);
  const double modulus = scene.material ? scene.material->young_modulus : 0;
  return std::max(kLeast, kOfTissue * modulus * radius);
}

double step_period(const Scene& scene) {
  if (scene.rate_hz <= 0) {
    fail(
        "{}: `rate_hz` = 0, but model \"{}\" must know the time of a step beforehand; name a rate, such as "
        "30",
        scene.rate_where, scene.deformation.model);
  }
  return 1 / scene.rate_hz;
}

std::vector<int> fixed_now(std::span<const int> fixed, std::span<const int> places) {
  std::vector<int> at_rest;
  std::ranges::copy_if(fixed, std::back_inserter(at_rest),
                       [&](int v) { return places[static_cast<std::size_t>(v)] < 0; });
  return at_rest;
}

}  // namespace palpate::sim
