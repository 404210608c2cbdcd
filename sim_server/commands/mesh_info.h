#pragma once
#include <string>

#include "common/program.h"

namespace palpate::sim {

/// `sim_server mesh info FILE`: prints every fault, what was done about it or is to be, and the size and
/// quality of a mesh that is usable. Returns 0. Throws `Error` where it is not usable, or cannot be read.
int print_mesh_info(const std::string& file);

/// `sim_server mesh info`.
Command mesh_command();

}  // namespace palpate::sim
