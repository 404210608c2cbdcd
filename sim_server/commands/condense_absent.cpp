#include "common/error.h"
#include "sim_server/commands/condense.h"

namespace palpate::sim {

int condense(const CondenseOptions& options) {
  fail(
      "condense {}: this build has no MPI; configure it with -DPALPATE_MPI=ON (scripts/setup --mpi installs "
      "what that needs)",
      options.scene.string());
}

}  // namespace palpate::sim
