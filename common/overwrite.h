#pragma once
#include <vector>

#include "common/program.h"
#include "common/report.h"

namespace palpate {

/// Option "--force" of a command that writes captures or tables.
Option force_option(bool& force);

/// Throws `Error` (input) where one of these captures or tables is there already and holds something, so that
/// it would be lost; not with `force`. Devices and pipes are nothing to lose.
void require_new(const std::vector<NamedFile>& files, bool force);

}  // namespace palpate
