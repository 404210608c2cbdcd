#pragma once
#include "sim_server/study/study_errors.h"

namespace palpate::sim {

/// A case of a study with all that is reported about it.
struct StudyRow {
  std::string scene;
  StudyCase one;
  StudyErrors errors;
  std::size_t tetrahedra = 0, nodes = 0;
  int flagged = 0;      ///< steps
  bool touched = true;  ///< in some step; else no time of steps in contact is known
  std::uint64_t state_hash = 0;
  double step_ms_p50 = 0, step_ms_p99 = 0, setup_ms = 0, peak_bytes = 0;
  bool on_front = false;  ///< no other row has a smaller error of the force at no more time a step
};

/// Result of a study.
struct StudyResult {
  StudyErrors own;  ///< of the check against the reference, which bounds the reference's own
  std::vector<StudyRow> rows;
  std::string reference = {}, check = {};
  Trace truth = {};                                               ///< of the reference
  std::optional<ForceJumps> jumps = {};                           ///< between its steps
  std::vector<std::pair<std::string, std::string>> refused = {};  ///< case, why
};

/// Finds the rows on the front of error against time, among those of which every step settled.
void mark_front(std::vector<StudyRow>& rows);
/// A table for a terminal, best front first.
std::string to_text(const StudyResult& result);
/// Returns advice: one sentence, and TOML to paste into the scene. It names the case with the smallest error
/// of the rendered force, among the cases on meshes that are files. Their median time a step must exceed
/// neither `budget_ms` nor their own time step. `requested`: the scene itself.
std::string advice(const StudyResult& result, double budget_ms, const Scene& requested);
/// rows.csv, timing.csv, along.csv, reference.csv (tool and force, step by step) and summary.json. Throws
/// `Error`.
void write_study(const StudyOptions& options, const StudyResult& result);

}  // namespace palpate::sim
