#pragma once
#include "common/config.h"
#include "sim_server/scene/scene.h"

namespace palpate::sim {

/// `[[material.inclusion]]` of a `[material]`. Throws `Error`.
std::vector<Inclusion> read_inclusions(const Config& material);

}  // namespace palpate::sim
