#pragma once
#include <filesystem>

#include "common/program.h"

namespace palpate::sim {

/// `sim_server keygen FILE`: makes a key, in a file that only its owner reads, and says where it goes; `add`:
/// puts a new one behind those of a file. Throws `Error`. Returns 0.
int make_key(const std::filesystem::path& file, bool add);

/// `sim_server keygen`.
Command keygen_command();

}  // namespace palpate::sim
