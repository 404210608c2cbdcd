#pragma once
#include "common/error.h"
#include "common/trajectory.h"
#include "sim_server/study/study_plan.h"

namespace palpate::sim {

/// Results of one case along the motion; N, N/m, m, s. Step k ends at time (k + 1) / rate of its scene.
struct Trace {
  double dt = 0;
  std::vector<Vec3> places, forces;  ///< (steps) of the tool, on the tool
  std::vector<Mat3> tangents;        ///< (steps)
  std::vector<Vec3> moved;           ///< (steps x sites) displacement of the surface at each site
  std::size_t sites = 0;
  int flagged = 0;  ///< steps without a settled answer
  std::size_t tetrahedra = 0, nodes = 0;
  std::uint64_t state_hash = 0;
  double setup_ms = 0, step_ms_p50 = 0, step_ms_p99 = 0;  ///< of steps in contact
  double peak_bytes = 0;                                  ///< resident, of a process that runs it
};

/// The tool pressed on the scene by half its radius, slid to and fro by its radius and lifted, in 2 s: where
/// `find_press` says. Builds the scene once.
Trajectory press_and_slide(const StudyCase& one);

/// Runs a case along a motion for `seconds`, displacement recorded at `sites` (m, rest, on or near the
/// surface). One thread and what the model uses; takes as long as it takes.
Trace run_case(const StudyCase& one, const Trajectory& motion, double seconds, std::span<const Vec3> sites);

/// The box of a motion, larger by `margin` (m) on all sides.
Box around(const Trajectory& motion, double margin);

/// Returns the sites where displacement is compared: at most 1500 surface vertices of the scene's own mesh in
/// a box, at rest, m.
std::vector<Vec3> compared_sites(const StudyCase& one, const Box& box);

/// Writes a trace so that it reads back bit by bit. Throws `Error`.
void write_trace(const std::filesystem::path& file, const Trace& trace);
/// Reads it, or gives nothing where there is none, or not a whole one.
std::optional<Trace> read_trace(const std::filesystem::path& file);

/// A case that came to no end: refused, out of memory, crashed. The other cases of a study go on.
struct CaseFailed : Error {
  using Error::Error;
};

/// Runs `work` in a process of its own, which has the machine's memory and threads to itself, and gives how
/// much more than at its beginning was resident at most, bytes. Throws `CaseFailed`, with what an `Error`
/// there said; an `Error` where it was interrupted. To be called before this process has threads.
double run_separately(const std::string& name, const std::function<void()>& work);

}  // namespace palpate::sim
