#pragma once
#include "common/program.h"
#include "sim_server/commands/cache.h"
#include "sim_server/study/study_plan.h"

namespace palpate::sim {

/// Error against run time of one scene: runs it as itself and along one axis at a time (model, element, mesh,
/// step, tolerance), each in a process of its own, one at a time, and holds each against a reference that it
/// computes first. Writes into `out`: rows.csv (the same on every run), timing.csv (what depends on the
/// machine), along.csv (error along the run), summary.json (all) and traces/ (kept: a run that was
/// interrupted goes on from there). What it says of the scene as it is goes into the cache, for the reports
/// of later sessions. Prints a table and, with a budget, what to choose. Throws `Error`. Returns the exit
/// code.
int study(const StudyOptions& options, const CacheOptions& cache);

/// `sim_server study`.
Command study_command();

}  // namespace palpate::sim
