#pragma once
#include <optional>

#include "protocol/c_interface/palpate.h"
#include "protocol/messages.h"

namespace palpate::c_interface {

/// Writes that message as the struct of the other language; the caller sets `struct_size`. No allocation.
void write_tool_state(const protocol::ToolState& from, palpate_tool_state& to) noexcept;
void write_force_sample(const protocol::ForceSample& from, palpate_force_sample& to) noexcept;

/// Place, velocity (only with PALPATE_HAS_VELOCITY), orientation, buttons and the flags that a caller may
/// set. Nothing where the protocol could not carry it: not finite, too far, or turned by no unit quaternion.
/// Of a tool that is lost, any numbers will do. No allocation.
std::optional<protocol::ToolState> read_tool_state(const palpate_tool_state& from) noexcept;

}  // namespace palpate::c_interface
