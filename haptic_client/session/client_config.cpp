#include "haptic_client/session/client_config.h"

#include <algorithm>

#include "common/config.h"
#include "common/error.h"
#include "common/text.h"
#include "haptic_client/extrapolation/extrapolators.h"

namespace palpate::client {
namespace {

OperatorSettings read_operator(const Config& config) {
  OperatorSettings hand;
  hand.mass = config.number("mass", {0.01, 10, "kg"}, hand.mass);
  hand.device_damping = config.number("device_damping", {0, 100, "N s/m"}, hand.device_damping);
  hand.hand_stiffness = config.number("hand_stiffness", {0, 1e5, "N/m"}, hand.hand_stiffness);
  hand.hand_damping = config.number("hand_damping", {0, 1e3, "N s/m"}, hand.hand_damping);
  hand.max_force = config.number("max_force", {0.01, 100, "N"}, hand.max_force);
  config.reject_unknown();
  if (!SimulatedHand::is_stable(hand))
    fail(
        "{}: a hand of {:g} kg that is damped by {:g} and {:g} N s/m moves faster than its sub-steps of {:g} "
        "ms "
        "follow; take a larger `mass` or less damping",
        config.where(), hand.mass, hand.hand_damping, hand.device_damping, 1e3 * SimulatedHand::kSubStep);
  return hand;
}

FalconSettings read_falcon(const Config& config) {
  FalconSettings falcon;
  if (config.has("firmware")) falcon.firmware = config.file("firmware");
  falcon.torque_constant =
      config.number("torque_constant", {100, 50000, "DAC units per N m"}, falcon.torque_constant);
  if (config.has("frozen_fade")) falcon.frozen_fade = config.number("frozen_fade", {0.5, 3600, "s"}, 0);
  config.reject_unknown();
  return falcon;
}

SpaceMouseSettings read_spacemouse(const Config& config) {
  SpaceMouseSettings mouse;
  mouse.speed = config.number("speed", {0.001, 1, "m/s"}, mouse.speed);
  mouse.reach = config.number("reach", {0.001, 1, "m"}, mouse.reach);
  config.reject_unknown();
  return mouse;
}

Workspace read_client_workspace(const Config& config) {
  Workspace workspace = read_workspace(config);
  workspace.clutch = static_cast<std::uint16_t>(config.integer("clutch", {0, 0xffff, "button bits"}, 0));
  config.reject_unknown();
  return workspace;
}

Limiter::Settings read_limits(const Config& config) {
  Limiter::Settings limits;
  limits.max_force = config.number("force", {0.01, 100, "N"}, limits.max_force);
  limits.max_slew = config.number("slew", {0.1, 1e5, "N/s"}, limits.max_slew);
  config.reject_unknown();
  return limits;
}

Passivity::Settings read_passivity(const Config& config) {
  Passivity::Settings passivity;
  passivity.enabled = config.flag("enabled", passivity.enabled);
  passivity.allowance = config.number("allowance", {0, 10, "W"}, passivity.allowance);
  passivity.debt = config.number("debt", {1e-6, 10, "J"}, passivity.debt);
  passivity.damping = config.number("damping", {0, 100, "N s/m"}, passivity.damping);
  config.reject_unknown();
  return passivity;
}

}  // namespace

std::vector<std::string> ClientConfig::scored_laws() const {
  std::vector<std::string> laws,
      requested = score.value_or(std::vector<std::string>{"constant", "linear_time", "linear_position"});
  if (!score || !score->empty()) requested.push_back(method);
  for (const std::string& law : requested) {
    if (std::ranges::find(laws, law) == laws.end()) laws.push_back(law);
  }
  return laws;
}

Limiter::Settings ClientConfig::device_limits() const {
  Limiter::Settings settings = limits;
  const DeviceLimits most = row_of(device).limits(device);
  settings.max_force = std::min(settings.max_force, most.max_force);
  return settings;
}

ClientConfig read_client_config(const std::filesystem::path& file) {
  const Config config = Config::read(file);
  if (config.has("mesh") || config.has("deformation"))
    fail(
        "{}: is a scene, for `sim_server run {}`; a client file of that scene is named in its [session] "
        "clients",
        file.string(), file.string());
  ClientConfig client;
  client.server = config.text("server", client.server);
  client.server_where = config.where("server");
  if (config.has("key")) client.key = config.file("key");
  client.rate_hz = config.number("rate_hz", {kMinRate, kMaxRate, "Hz"}, client.rate_hz);
  client.method = config.text("method", client.method);
  client.method_where = config.where("method");
  find_row(extrapolators(), client.method, "method", client.method_where);
  client.blend = 1e-3 * config.number("blend_ms", {0, 100, "ms"}, 1e3 * client.blend);
  client.score_where = config.where("score");
  if (config.has("score")) client.score = config.texts("score", {}, {});
  for (const std::string& law : client.scored_laws())
    find_row(extrapolators(), law, "method", client.score_where);
  if (const auto device = config.table("device")) {
    choose_device(client.device, device->text("name", client.device.name), device->where("name"));
    device->reject_unknown();
  }
  if (const auto hand = config.table("operator")) client.device.hand = read_operator(*hand);
  if (const auto falcon = config.table("falcon")) client.device.falcon = read_falcon(*falcon);
  if (const auto mouse = config.table("spacemouse")) client.device.spacemouse = read_spacemouse(*mouse);
  if (const auto trajectory = config.table("trajectory"))
    client.device.trajectory = read_trajectory_settings(*trajectory);
  if (const auto workspace = config.table("workspace")) client.workspace = read_client_workspace(*workspace);
  // The file tells the motion in the world; the simulated hand moves in the device frame.
  if (client.device.trajectory) client.device.trajectory->frame = client.workspace;
  if (const auto limits = config.table("limits")) client.limits = read_limits(*limits);
  if (const auto passivity = config.table("passivity")) client.passivity = read_passivity(*passivity);
  config.reject_unknown();
  return client;
}

}  // namespace palpate::client
