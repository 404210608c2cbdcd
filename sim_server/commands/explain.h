#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/program.h"
#include "common/report.h"
#include "sim_server/commands/cache.h"
#include "sim_server/simulation/simulation.h"
#include "sim_server/simulation/step_times.h"

namespace palpate::sim {

/// Options of `sim_server explain`.
struct ExplainOptions {
  std::filesystem::path scene;
  std::optional<std::filesystem::path> json;
  std::optional<std::string> why;  ///< of this part alone
  int steps = 200;                 ///< timed, free and in contact each
  CacheOptions cache;
};

/// Something a scene builds.
struct BuiltPart {
  std::string part, detail;  ///< its name; counts
  std::string where;         ///< "FILE:LINE" that asks for it, or "always"
  std::size_t bytes = 0;     ///< held while the scene is served
  double setup_ms = 0;
};

/// Something a scene does not build, and what it would cost more: absent where that was not measured.
struct Omitted {
  std::string what;
  std::string why;                   ///< "FILE:LINE", or the section that is not there
  std::optional<double> bytes{};     ///< of all parts together
  std::optional<double> setup_ms{};  ///< without reading the mesh, which all variants share
  std::optional<double> step_ms{};   ///< between medians in contact
  std::string note{};                ///< measured, computed, or why neither
};

/// Parts and costs of a scene on this machine.
struct Explanation {
  Scene scene;
  std::vector<BuiltPart> built;
  std::vector<Omitted> omitted;
  StepTimes steps;
  std::uint64_t state_hash = 0;  ///< after the steps in contact
  std::size_t tetrahedra = 0;
  double peak_bytes = 0;  ///< resident of this process at most, with its program, until then: measured
};

/// Builds the scene and, where that takes no more than 10 s, a variant for each thing it leaves out, and
/// steps them all, `steps` free and as many in contact each; those that are not among what is `condensed`
/// are not built. Throws `Error` where the scene itself cannot be built. Takes as long as all those set-ups,
/// and the memory of two of them.
Explanation explain(const Scene& scene, const Progress& progress = kSilent, int steps = 200,
                    const SetupCache* cache = nullptr, const Condensed* condensed = nullptr);

/// Which line of the scene asks for a part, or leaves it out, and what it costs or saves. Throws `Error`
/// naming the parts that there are.
std::string why_text(const Explanation& explanation, const std::string& part);

/// The three tables of it, in kB and ms, and the same in plain units (`bytes`, `setup_ms`, `step_ms`).
std::string to_text(const Explanation& explanation);
Json to_json(const Explanation& explanation);

/// Explains a scene on stdout, and in a file if asked. Throws `Error`. Returns the exit code.
int run_explain(const ExplainOptions& options);

/// `sim_server explain`.
Command explain_command();

/// Every model and what it is, for the help of commands that take a scene.
std::string list_of_models();

}  // namespace palpate::sim
