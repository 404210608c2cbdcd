#pragma once
#include <optional>

#include "common/discretisation_error.h"
#include "sim_server/scene/scene.h"
#include "sim_server/setup_cache/setup_cache.h"

namespace palpate::sim {

/// Keeps in the set-up cache what a study measured of a scene as it is: what its mesh and its time step cost
/// the force, % of its root mean square along the motion of the study, which took `seconds`. It is known by
/// the bytes of the scene's file, of its mesh and of this program, so that a change of any forgets it.
void keep_studied(const SetupCache& cache, const Scene& scene, const DiscretisationErrors& errors,
                  double seconds);

/// Returns the errors that a study of this scene measured; nothing where there was none.
std::optional<DiscretisationErrors> find_studied(const SetupCache& cache, const Scene& scene);

}  // namespace palpate::sim
