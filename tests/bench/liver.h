#pragma once
#include "sim_server/simulation/step_times.h"
#include "tests/support/scenes.h"

namespace palpate::bench {

constexpr int kHashedSteps = 200;  // free, then as many in contact; as `sim_server explain` does

/// The scene that ships, with another model.
inline sim::Scene liver_scene_with(std::string_view model) {
  sim::Scene scene = test::liver_scene();
  scene.deformation.model = model;
  return scene;
}

/// State hash after a fixed number of steps, free and in contact.
inline std::uint64_t contact_hash(const sim::Scene& scene, sim::Simulation& simulation,
                                  const sim::Press& press) {
  sim::time_steps(scene, simulation, press, kHashedSteps);
  return simulation.state_hash();
}

}  // namespace palpate::bench
