#include "sim_server/deformation/model_inputs.h"

#include "common/error.h"

namespace palpate::sim {

double step_period(const Scene& scene) {
  if (scene.rate_hz <= 0) {
    fail(
        "{}: `rate_hz` = 0, but model \"{}\" must know the time of a step beforehand; name a rate, such as "
        "30",
        scene.rate_where, scene.deformation.model);
  }
  return 1 / scene.rate_hz;
}

}  // namespace palpate::sim
