#pragma once
#include "sim_server/scene/scene.h"

namespace palpate::sim {

/// Purpose of reading a scene: to serve it, or to solve it without a tool, which needs neither [deformation]
/// nor [[tool]].
enum class Purpose { kServe, kSolve };

/// Reads and checks a scene file. Throws `Error` (file, line, key, what was expected). Does not read the
/// mesh.
Scene read_scene(const std::filesystem::path& file, Purpose purpose = Purpose::kServe);

}  // namespace palpate::sim
