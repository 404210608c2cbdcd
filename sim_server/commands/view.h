#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "common/program.h"
#include "sim_server/commands/cache.h"

namespace palpate::sim {

struct ViewOptions {
  std::filesystem::path capture;
  std::optional<std::filesystem::path> scene;  ///< of that session; absent: tools and forces alone are shown
  std::string viewer = "8080";
  bool insecure = false;          ///< other machines may see the page
  std::optional<double> seconds;  ///< stop after so long; absent: at Ctrl-C
  CacheOptions cache;
};

/// Makes of a capture what a page would have got, and serves that until Ctrl-C. Throws `Error`. Returns the
/// exit code.
int view_capture(const ViewOptions& options);

/// `sim_server view`.
Command view_command();

}  // namespace palpate::sim
