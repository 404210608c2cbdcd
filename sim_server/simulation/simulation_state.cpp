// State of a simulation as a value: parts of Simulation.
#include "sim_server/simulation/simulation.h"

namespace palpate::sim {

struct SimulationState::Saved {
  TetMesh mesh;  // as the cuts so far have it
  Surface surface;
  std::vector<Vec3> rest;
  std::optional<TissueCut> cut;
  std::any model;
  Tissue::State tissue;
  ToolGroup::State tools;
  StepPublisher publisher;
  Simulation::State state;
};

SimulationState Simulation::save() {
  StatefulModel* const model = tissue_.traits.state;
  SimulationState state;
  state.saved_ = std::make_shared<const SimulationState::Saved>(SimulationState::Saved{
      *organ_.mesh, organ_.surface, organ_.rest, cut_, model != nullptr ? model->save() : std::any(),
      tissue_.save(), tools_.save(), publisher_, state_});
  return state;
}

void Simulation::restore(const SimulationState& state) {
  const SimulationState::Saved& saved = *state.saved_;
  StatefulModel* const model = tissue_.traits.state;
  const FreeMotion motion = model != nullptr ? model->restore(saved.model) : tissue_.model->free_motion(0);
  *organ_.mesh = saved.mesh;
  organ_.surface = saved.surface;
  organ_.rest = saved.rest;
  cut_ = saved.cut;
  tissue_.restore(saved.tissue, motion);
  tools_.restore(saved.tools);
  publisher_ = saved.publisher;
  state_ = saved.state;
}

}  // namespace palpate::sim
