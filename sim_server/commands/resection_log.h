#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "common/program.h"
#include "common/report.h"
#include "sim_server/simulation/simulation.h"

namespace palpate::sim {

/// Throws `Error` where `option` names a FILE, but the scene cuts nothing, or FILE cannot be written.
void require_resection(const char* option, const std::optional<std::filesystem::path>& file,
                       const Scene& scene);

/// Throws `Error` where `option` names a FILE of removals, but a tool has a blade.
void require_no_blade(const char* option, const std::optional<std::filesystem::path>& file,
                      const Scene& scene);

/// Writes a CSV with a row for each step with a hot tip: time, tool, place, force, and what the resection has
/// come to by then; units stand in the names of the columns. Throws `Error` (run time).
void write_resection(const std::filesystem::path& file, const Simulation& simulation);

/// The tetrahedra that went, as `--removals` writes and `--remove` reads them. Throws `Error`, of a file that
/// is none, or, where it is to be used, that names another mesh's (file and row).
void write_removals(const std::filesystem::path& file, const Simulation& simulation);
/// List of removals, and where the middle of each tetrahedron was at rest, m.
struct ListedRemovals {
  std::vector<Removal> removals;
  std::vector<Vec3> centres;
};
ListedRemovals read_removals(const std::filesystem::path& file);

/// Checks that a simulation may remove these. Throws `Error`, naming the file and row, where it may not.
void require_removable(const ListedRemovals& list, const std::filesystem::path& file,
                       const Simulation& simulation);

/// Writes the final state of the resection, for a report; null: nothing can be cut.
Json resection_report(const Simulation& simulation);
/// Returns that state in one line; empty: nothing can be cut.
std::string resection_text(const Simulation& simulation);

/// `--resection`.
Option resection_option(std::optional<std::filesystem::path>& file);

}  // namespace palpate::sim
