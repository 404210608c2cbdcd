#pragma once
#include "common/config.h"
#include "sim_server/scene/scene.h"

namespace palpate::sim {

/// Reads whichever of the three a `[[tool]]` has, after its shape. The last two are of the tool's tip: its
/// own size is added, and 20 mm by which tissue may come nearer as it deforms. Throws `Error`.
void read_reach(const Config& config, ToolSettings& tool);

}  // namespace palpate::sim
