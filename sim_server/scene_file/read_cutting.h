#pragma once
#include "common/config.h"
#include "sim_server/scene/cutting.h"

namespace palpate::sim {

/// `[cutting]`. Throws `Error`.
Cutting read_cutting(const Config& config);

}  // namespace palpate::sim
