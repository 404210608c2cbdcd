#pragma once
#include <optional>

#include "sim_server/setup_cache/setup_cache.h"
#include "sim_server/simulation/error_of_force.h"
#include "sim_server/study/study_run.h"

namespace palpate::sim {

/// Returns where the tool of a trace pressed, and how hard; nothing where it never touched.
std::optional<StudiedErrors> pressed_in(const Trace& trace);

/// Keeps in the set-up cache what a study measured of a scene as it is: what its mesh and its time step cost
/// the force, % of its root mean square along the motion of the study, which took `seconds`; and where and
/// how hard it pressed. It is known by the bytes of the scene's file, of its mesh and of this program, so
/// that a change of any, also of the radius of a tool or of the material, forgets it.
void keep_studied(const SetupCache& cache, const Scene& scene, const StudiedErrors& errors, double seconds);

/// Returns the errors that a study of this scene measured; nothing where there was none.
std::optional<StudiedErrors> find_studied(const SetupCache& cache, const Scene& scene);

}  // namespace palpate::sim
