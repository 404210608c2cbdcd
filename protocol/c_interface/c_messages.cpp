#include "protocol/c_interface/c_messages.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace palpate::c_interface {
using protocol::ForceSample;
using protocol::ToolState;

namespace {

/// True if a bit of the C interface is that of the message.
constexpr bool same(int bit, std::uint32_t flag) {
  return static_cast<std::uint32_t>(bit) == flag;
}

static_assert(same(PALPATE_LOST, ToolState::kDeviceLost) && same(PALPATE_REARMED, ToolState::kRearmed) &&
              same(PALPATE_CLUTCHED, ToolState::kClutched) &&
              same(PALPATE_WANTS_TANGENT, ToolState::kRequestsTangent));
static_assert(same(PALPATE_IN_CONTACT, ForceSample::kInContact) &&
              same(PALPATE_FLAGGED, ForceSample::kFlagged) &&
              same(PALPATE_HAS_TANGENT, ForceSample::kHasTangent) &&
              same(PALPATE_HAS_MEAN, ForceSample::kHasMean));
static_assert(PALPATE_TOOL_STATE == static_cast<int>(ToolState::kType) &&
              PALPATE_FORCE_SAMPLE == static_cast<int>(ForceSample::kType));

void write(const Vec3& from, double (&to)[3]) noexcept {
  std::copy(from.data(), from.data() + 3, to);
}

bool carried(const double (&v)[3]) noexcept {
  return std::all_of(v, v + 3, [](double x) { return std::abs(x) <= protocol::kMaxMagnitude; });
}

}  // namespace

void write_tool_state(const ToolState& from, palpate_tool_state& to) noexcept {
  to.flags = (from.flags & (PALPATE_LOST | PALPATE_REARMED | PALPATE_CLUTCHED | PALPATE_WANTS_TANGENT)) |
             PALPATE_HAS_VELOCITY;
  to.buttons = from.buttons;
  to.tool = from.tool;
  write(from.p_W, to.position);
  write(from.v_W, to.velocity);
  std::ranges::copy(from.q_W, to.orientation);
  to.time_ns = from.t_ns;
  to.tick = from.tick;
  to.newest_sample = from.newest_sample;
}

void write_force_sample(const ForceSample& from, palpate_force_sample& to) noexcept {
  to.flags = from.flags & (PALPATE_IN_CONTACT | PALPATE_FLAGGED | PALPATE_HAS_TANGENT | PALPATE_HAS_MEAN);
  to.tool = from.tool;
  to.reserved = 0;
  to.number = from.number;
  to.tick = from.tool_tick;
  to.time_ns = from.tool_t_ns;
  write(from.p_W, to.position);
  write(from.f_W, to.force);
  write(from.torque_W, to.torque);
  write(from.at_tool.normal_W, to.normal);
  to.gap = from.at_tool.gap;
  std::copy_n(from.at_tool.tangent.data(), 9, to.tangent);
  write(from.surface_v_W, to.surface_velocity);
  write(from.mean_f_W, to.mean_force);
  to.step_ns = from.step_ns;
}

std::optional<ToolState> read_tool_state(const palpate_tool_state& from) noexcept {
  ToolState to{.buttons = static_cast<std::uint16_t>(from.buttons),
               .flags = static_cast<std::uint16_t>(from.flags & (PALPATE_LOST | PALPATE_WANTS_TANGENT))};
  if ((from.flags & PALPATE_LOST) != 0) return to;
  const bool has_velocity = (from.flags & PALPATE_HAS_VELOCITY) != 0;
  if (!carried(from.position) || (has_velocity && !carried(from.velocity))) return {};
  to.p_W = Vec3(from.position);
  if (has_velocity) to.v_W = Vec3(from.velocity);
  std::copy(from.orientation, from.orientation + 4, to.q_W.begin());
  double square = 0;
  for (const double x : to.q_W) square += x * x;
  if (square == 0)
    to.q_W = {1, 0, 0, 0};
  else if (!(std::abs(square - 1) < protocol::limits::kUnitVector.tolerance))
    return {};
  return to;
}

}  // namespace palpate::c_interface
