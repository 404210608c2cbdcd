#pragma once
#include <vector>

#include "common/program.h"
#include "common/report.h"

namespace palpate {

/// Option "--force" of a command that writes captures or tables.
Option force_option(bool& force);

/// Keeps these captures or tables, where they are there already and hold something, under another name,
/// F.~1~, F.~2~ ..., and says so; not with `force`. What a link names is kept, and the link stays. Devices
/// and pipes are nothing to lose. Throws `Error` where a file cannot be renamed.
void set_aside(const std::vector<NamedFile>& files, bool force);

}  // namespace palpate
