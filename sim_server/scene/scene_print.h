#pragma once
#include "protocol/scene_print.h"
#include "sim_server/scene/scene.h"

namespace palpate::sim {

/// Returns hashes of what the forces of a scene on `mesh` follow from: the same for any rate, tolerance or
/// text of its file. `body`: what the settings of its model say of the body (`body_to_text`). Before the
/// first cut. O(tetrahedra), some 100 ns each.
protocol::ScenePrint print_of(const Scene& scene, const TetMesh& mesh, const std::string& body);

}  // namespace palpate::sim
