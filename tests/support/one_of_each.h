#pragma once
/// Messages of every kind, with numbers that have short bytes, and how they look on the wire.
#include <vector>

#include "protocol/codec.h"
#include "tests/support/hex.h"

namespace palpate::test {
using namespace protocol;

inline Bytes encoded(const Header& header, const Message& message) {
  Bytes bytes(kMaxDatagram);
  bytes.resize(encode(header, message, bytes));
  return bytes;
}

inline const Header kHeader{0x1122334455667788, 7};

inline std::vector<Message> one_of_each() {
  ToolState tool{
      .tool = 1, .tick = 9, .newest_sample = 8, .t_ns = 123456789, .p_W = {0.5, -1, 2}, .v_W = {0, 0.25, 0}};
  tool.buttons = 5;
  ForceSample force{.tool = 1,
                    .number = 3,
                    .tool_tick = 9,
                    .tool_t_ns = 123456789,
                    .p_W = {0.5, -1, 2},
                    .f_W = {0, 1.5, 0}};
  force.step_ns = 70000;
  force.flags = ForceSample::kInContact;
  ToolState asking = tool;
  asking.flags = ToolState::kRequestsTangent | ToolState::kRequestsAhead;
  asking.lead_ns = 0x0102030;
  ForceSample entire = force;
  entire.flags = ForceSample::kHasTangent | ForceSample::kHasAhead;
  entire.surface_v_W = {0.25, 0, -0.5};
  const Mat3 slope{{-1, -2, -3}, {-2, -4, -5}, {-3, -5, -6}};
  entire.at_tool = {.tangent = slope, .normal_W = {0, 1, 0}, .gap = 0.5};
  entire.ahead_p_W = {0.5, -1, 2};
  entire.ahead_f_W = {0, 1.5, 0};
  entire.ahead.tangent.diagonal() << -8, -16, -32;
  ToolState fetching = tool;
  fetching.flags = ToolState::kRequestsSurface | ToolState::kAsksPages;
  fetching.pages_taken = 0x0203;
  fetching.surface_version = 0xa1b2c3d4;
  fetching.pages = {7, 8, 9, 10, 11, 12, 13, ToolState::kNoPage};
  ForceSample on_surface = force;
  on_surface.flags = ForceSample::kHasSurface;
  on_surface.surface = {.version = 0xa1b2c3d4,
                        .vertices = 0x162,
                        .triangles = 0x2c0,
                        .tool_radius = 0.5,
                        .tool_friction = 0.25,
                        .tool_compliance = 2,
                        .shift_W = {0, -0.5, 0}};
  ForceSample with_errors = force;
  with_errors.flags = ForceSample::kHasErrors;
  with_errors.errors = {{ErrorSource::kEstimated, 3.5F}, {ErrorSource::kNone, 0}};
  ForceSample among_others = force;
  among_others.flags = ForceSample::kHasOthers;
  among_others.others = {{0.5, 0, -1}, slope};
  ForceSample swinging = force;
  swinging.flags = ForceSample::kHasModes | ForceSample::kHasMean;
  swinging.modes.count = 2;
  swinging.modes.q = {0.5F, -1};
  swinging.modes.v = {2, 0};
  swinging.mean_f_W = {0, 1.5, 0};
  ForceSample relaxing = swinging;
  relaxing.flags = ForceSample::kHasModes | ForceSample::kHasRelaxed;
  relaxing.relaxed = {.terms = 2, .first = 1, .count = 1, .vertices = 1};
  relaxing.relaxed.fraction = {0.5F, 0.25F};
  relaxing.relaxed.time = {0.125F, 2};
  relaxing.relaxed.z = {-1, 3};
  relaxing.relaxed.vertex[0] = {0x0102, {1, 2, 3, 0.5F, 0, -0.5F}};
  ForceSample driven = swinging;
  driven.flags = ForceSample::kHasModes | ForceSample::kHasModalLoads;
  driven.modal_loads.count = 2;
  driven.modal_loads.load = {-0.5F, 3};
  ForceSample of_cut = force;
  of_cut.flags = ForceSample::kHasCuts;
  of_cut.cuts = 0x01020304;
  SurfacePage page{.tool = 1, .version = 0xa1b2c3d4, .page = 0x0708};
  page.values.front() = 0.5F;
  page.values.back() = -2;
  Telemetry telemetry{.tool = 1, .flags = Telemetry::kHasMotors | Telemetry::kClutched, .t_ns = 123456789};
  telemetry.dt_ns = 2000000;
  telemetry.p_W = {0.5, -1, 2};
  telemetry.f_W = {0, 1.5, 0};
  telemetry.age_ns = 0x01020304;
  telemetry.loop.period_ns = 2000000;
  telemetry.loop.longest_period_ns = 0x0506;
  telemetry.loop.ticks = 9;
  telemetry.loop.missed = 2;
  telemetry.passivity_gain = 0.5F;
  telemetry.interventions = {.faded = 1, .clamped = 2, .slewed = 3, .damped = 4};
  telemetry.device = {'m', 'e'};
  telemetry.rendered_law = {'a', ':', ' ', 'b'};
  telemetry.named = 1;
  telemetry.name = {'c'};
  telemetry.error_percent = -1;
  telemetry.laws = 2, telemetry.count = 2;
  telemetry.rendered = {0.5F, 2};
  telemetry.by_law = {1, -2, 3, 0.5F};
  const Pointer pointer{.tool = 1, .number = 0x0102, .p_W = {0.5, -1, 2}, .buttons = 5};
  return {Hello{.nonce = {42}, .attempt = 5},
          Welcome{{42}, 5, {43, 44}, 1, 30, 0.005, {1, 2, 3, 0x01020304}},
          Refuse{{42}, 5, RefuseReason::kNoFreeTool},
          Bye{},
          tool,
          force,
          asking,
          entire,
          fetching,
          on_surface,
          page,
          with_errors,
          among_others,
          swinging,
          Challenge{{42}, 5, {45, 46}},
          relaxing,
          telemetry,
          pointer,
          driven,
          of_cut};
}

}  // namespace palpate::test
