#include <array>

#include "common/time.h"
#include "protocol/c_interface/border.h"
#include "protocol/c_interface/c_messages.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/scene_file/read_scene.h"
#include "sim_server/serving/served_tools.h"

using namespace palpate;

namespace {

constexpr double kLongestStep = 3600;                      // s
constexpr double kSameStep = 1e-5;                         // of a step: its time is rounded somewhere
constexpr Time kEnd = std::chrono::hours(24 * 365 * 100);  // 64 bits of ns hold nearly three of it

/// Element `i` of an array of the caller's structs, which may be longer than ours.
template <class Struct>
Struct& element(Struct* array, std::size_t i) {
  using Byte = std::conditional_t<std::is_const_v<Struct>, const char, char>;
  return *reinterpret_cast<Struct*>(reinterpret_cast<Byte*>(array) + i * array->struct_size);
}

template <class Struct>
void require_array(Struct* array, std::size_t count, const char* name) {
  for (std::size_t i = 0; i < count; ++i) {
    c_interface::require_complete(i == 0 ? array : &element(array, i), name);
    if (element(array, i).struct_size != array->struct_size)
      fail("{}: element {} has another struct_size than the first", name, i);
  }
}

}  // namespace

/// A scene with its tools, each in the hand of the caller. Time is that of the steps.
struct palpate_scene {
  explicit palpate_scene(const char* file) : palpate_scene(sim::read_scene(file)) {}
  explicit palpate_scene(const sim::Scene& scene)
      : simulation(scene), served(simulation), inputs(simulation.tools()) {
    simulation.set_cut_options({.keeps_log = false});
    const sim::DeformationModelRow& model = sim::model_of(scene.deformation);
    if (model.moves && model.deforms()) step_s = 1 / scene.rate_hz;
  }

  /// Throws `Error` unless a step may take so long.
  void require_step(double dt) const;

  void step(const palpate_tool_state* tools, Time dt, palpate_force_sample* samples);

  sim::Simulation simulation;
  sim::ServedTools served;
  std::vector<sim::SessionInput> inputs;
  std::optional<double> step_s;  // of tissue in motion, whose steps all take that long
  Time now{};
  std::uint64_t steps = 0;

 private:
  protocol::ToolState state_of(std::size_t i, const palpate_tool_state& published, Time then) const;
};

void palpate_scene::require_step(double dt) const {
  if (!(dt >= 0 && dt <= kLongestStep)) fail("dt: expected 0 to {:g} s, not {:g}", kLongestStep, dt);
  if (now > kEnd) fail("dt: the scene has run for a hundred years; open it again");
  if (dt == 0 || !step_s || std::abs(dt - *step_s) <= kSameStep * *step_s) return;
  fail(
      "dt: the tissue of this scene is in motion, in steps of 1 / rate_hz = {:g} s; not {:g}; take that, or "
      "0, or "
      "set `rate_hz` = {:g} in the scene",
      *step_s, dt, 1 / dt);
}

/// Returns the state of tool `i` at the end of the step.
protocol::ToolState palpate_scene::state_of(std::size_t i, const palpate_tool_state& published,
                                            Time then) const {
  auto state = c_interface::read_tool_state(published);
  if (!state)
    fail("tools: the state of tool {} is not finite, beyond 1e9, or turned by no unit quaternion", i);
  const protocol::ToolState& before = inputs[i].state;
  const bool was_there = steps > 0 && (before.flags & protocol::ToolState::kDeviceLost) == 0;
  state->tool = static_cast<std::uint8_t>(i);
  state->tick = steps + 1;
  state->t_ns = then.count();
  if ((published.flags & PALPATE_HAS_VELOCITY) == 0 && was_there && then > now)
    state->v_W = (state->p_W - before.p_W) / to_seconds(then - now);
  return *state;
}

void palpate_scene::step(const palpate_tool_state* tools, Time dt, palpate_force_sample* samples) {
  std::array<protocol::ToolState, kMaxTools> states;
  for (std::size_t i = 0; i < inputs.size(); ++i) states[i] = state_of(i, element(tools, i), now + dt);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    inputs[i].session = i + 1;
    inputs[i].state = states[i];
    inputs[i].fresh = true;
    inputs[i].path.add(states[i]);
  }
  now += dt;
  ++steps;
  const auto outcomes = served.step(inputs, to_seconds(dt));
  for (std::size_t i = 0; i < inputs.size(); ++i)
    c_interface::write_force_sample(*outcomes[i].answer, element(samples, i));
}

int palpate_scene_open(const char* file, palpate_scene** scene, char* error, std::size_t error_size) {
  if (scene != nullptr) *scene = nullptr;
  return c_interface::guarded(error, error_size, [&] {
    if (file == nullptr || scene == nullptr) fail("palpate_scene_open: file or scene is NULL");
    *scene = new palpate_scene(file);
  });
}

std::size_t palpate_scene_tools(const palpate_scene* scene) {
  return scene == nullptr ? 0 : scene->inputs.size();
}

int palpate_scene_step(palpate_scene* scene, const palpate_tool_state* tools, std::size_t count, double dt,
                       palpate_force_sample* samples, char* error, std::size_t error_size) {
  return c_interface::guarded(error, error_size, [&] {
    c_interface::require_handle(scene, "scene");
    if (count != scene->inputs.size())
      fail("count: the scene has {} tools, not {}", scene->inputs.size(), count);
    require_array(tools, count, "tools");
    require_array(samples, count, "samples");
    scene->require_step(dt);
    scene->step(tools, from_seconds(dt), samples);
  });
}

void palpate_scene_close(palpate_scene* scene) {
  delete scene;
}
