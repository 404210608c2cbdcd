#include "sim_server/commands/resection_log.h"

#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/csv.h"
#include "common/error.h"

namespace palpate::sim {
namespace {

constexpr const char* kColumns =
    "t_s,tool,x_m,y_m,z_m,force_N,contact,tetrahedra,removed_ml,dropped_ml,pieces_dropped,pieces_loose,"
    "cut_area_cm2,mean_distance_mm,farthest_mm,heat_J,elastic_J,kinetic_J,hot_s,contact_s,parted_cm2,"
    "mean_parted_distance_mm,at_end_s\n";

/// Distances from the plan of what was removed, and of what was parted; nothing where there is no plan, or
/// none of it yet.
struct FromPlan {
  std::optional<double> mean, furthest, mean_separated;  // m

  FromPlan(const ResectionTotals& all, bool planned) {
    if (planned && all.tetrahedra > 0) mean = all.mean_distance(), furthest = all.furthest;
    if (planned && all.separated_area > 0) mean_separated = all.mean_separated_distance();
  }
};

/// mm, or an empty cell.
std::string cell_of(const std::optional<double>& metres) {
  return metres ? fmt::format("{:.6g}", 1e3 * *metres) : "";
}

std::string row_text(const ResectionRow& row, bool planned) {
  const ResectionTotals& all = row.totals;
  const FromPlan away(all, planned);
  return fmt::format(
      "{:.6g},{},{:.6g},{:.6g},{:.6g},{:.6g},{},{},{:.6g},{:.6g},{},{},{:.6g},{},{},{:.6g},{:.6g},{:.6g},"
      "{:.6g},{:.6g},{:.6g},{},{:.6g}\n",
      row.t, row.tool + 1, row.p_W.x(), row.p_W.y(), row.p_W.z(), row.f_W.norm(), row.contact ? 1 : 0,
      all.tetrahedra, 1e6 * all.volume, 1e6 * all.dropped_volume, all.dropped_pieces, all.loose_pieces,
      1e4 * all.cut_area, cell_of(away.mean), cell_of(away.furthest), all.heat, all.elastic, all.kinetic,
      all.hot_time, all.contact_time, 1e4 * all.separated_area, cell_of(away.mean_separated),
      all.time_at_end);
}

Vec3 centre_of_number(const TetMesh& mesh, int tetrahedron) {
  return centre_of(mesh, mesh.tetrahedra[static_cast<std::size_t>(tetrahedron)]);
}

std::string place_text(const Vec3& x) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", x.x(), x.y(), x.z());
}

/// Returns how far a cut is from the plan, where there is one.
std::string away(bool planned, double metres, const char* how) {
  return planned ? fmt::format(", {:.1f} mm from the plan {}", 1e3 * metres, how) : "";
}

std::string heat_text(const ResectionTotals& all, bool planned) {
  if (all.hot_time == 0 && all.distance_sum == 0) return {};
  const std::string at_end =
      all.time_at_end > 0 ? fmt::format("; {:.1f} s at the end of what can be cut", all.time_at_end) : "";
  return fmt::format("; {:.0f} J of heat in {:.1f} s{}{}", all.heat, all.hot_time,
                     away(planned && all.mean_distance() > 0, all.mean_distance(), "on average"), at_end);
}

std::string outrun_text(const ResectionTotals& all) {
  if (all.outrun_steps == 0) return {};
  return fmt::format(
      "; in {} steps it was felt too late, as it had gone farther in a step than its edge is long: these are "
      "flagged (cut more slowly, or with a higher `rate_hz`)",
      all.outrun_steps);
}

std::string separated_text(const ResectionTotals& all, bool planned) {
  if (all.slides == 0 && all.splits == 0) return {};
  return fmt::format(
      "; a blade parted {:.1f} cm2{}: {} vertices became two, {} slid onto its way{}",
      1e4 * all.separated_area, away(planned, all.mean_separated_distance(), "on average"), all.splits,
      all.slides,
      outrun_text(all) +
          (all.ran_out ? "; it went through more, for which there were no vertices left" : ""));
}

}  // namespace

void require_resection(const char* option, const std::optional<std::filesystem::path>& file,
                       const Scene& scene) {
  if (!file) return;
  if (!scene.cutting)
    fail("{}: {} has no [cutting], so that nothing is removed; leave it out, or add one", option,
         scene.source);
  check_writable(*file, Contents::kTable);
}

void require_no_blade(const char* option, const std::optional<std::filesystem::path>& file,
                      const Scene& scene) {
  if (file && scene.blade() != nullptr)
    fail("{}: {} parts tissue by a blade, which these files do not tell; leave it out", option,
         scene.blade()->blade_where);
}

void write_resection(const std::filesystem::path& file, const Simulation& simulation) {
  AtomicFile atomic_file(file, Contents::kTable);
  std::ofstream out(atomic_file.path());
  out << kColumns;
  const TissueCut* const cut = simulation.cut();
  for (const ResectionRow& row : cut ? cut->log() : std::span<const ResectionRow>())
    out << row_text(row, simulation.resection()->has_plan());
  out.close();
  if (!out) fail_at_run_time("{}: could not be written; is the disk full?", file.string());
  atomic_file.commit();
}

void write_removals(const std::filesystem::path& file, const Simulation& simulation) {
  AtomicFile atomic_file(file, Contents::kTable);
  std::ofstream out(atomic_file.path());
  out << "t_s,tetrahedron,x_m,y_m,z_m\n";
  const TissueCut* const cut = simulation.cut();
  for (const Removal& removal : cut ? cut->removals() : std::span<const Removal>()) {
    const Vec3 centre = centre_of_number(simulation.mesh(), removal.tetrahedron);
    out << fmt::format("{:.9f},{},{:.9f},{:.9f},{:.9f}\n", removal.t, removal.tetrahedron, centre.x(),
                       centre.y(), centre.z());
  }
  out.close();
  if (!out) fail_at_run_time("{}: could not be written; is the disk full?", file.string());
  atomic_file.commit();
}

ListedRemovals read_removals(const std::filesystem::path& file) {
  const CsvTable table(file);
  const std::vector<std::string> columns{"t_s", "tetrahedron", "x_m", "y_m", "z_m"};
  if (table.has("tetrahedron") && !table.has("x_m"))
    fail(
        "{}: has no columns x_m, y_m and z_m, m, the middle of each tetrahedron, by which it is known to be "
        "of "
        "this mesh; make it again: `sim_server record ... --removals FILE`",
        file.string());
  const auto values = table.columns(columns);
  ListedRemovals list;
  for (std::size_t row = 0; row < values[0].size(); ++row) {
    const double t = values[0][row], number = values[1][row];
    if (row > 0 && t < list.removals.back().t)
      fail("{}: column t_s must not decrease, but data row {} has {:g} after {:g}", file.string(), row + 1, t,
           list.removals.back().t);
    if (!(number >= 0 && number <= std::numeric_limits<int>::max() && number == std::floor(number)))
      fail("{}: data row {} names tetrahedron {:g}, which no mesh has", file.string(), row + 1, number);
    list.removals.push_back({t, static_cast<int>(number)});
    list.centres.emplace_back(values[2][row], values[3][row], values[4][row]);
  }
  return list;
}

void require_removable(const ListedRemovals& list, const std::filesystem::path& file,
                       const Simulation& simulation) {
  constexpr double kRounding = 1e-8;  // m: the list has nanometres
  const auto tetrahedra = static_cast<int>(simulation.mesh().tetrahedra.size());
  for (std::size_t row = 0; row < list.removals.size(); ++row) {
    const int number = list.removals[row].tetrahedron;
    if (number >= tetrahedra)
      fail("{}: data row {} names tetrahedron {}, and the mesh has 0 to {}; is it of another mesh?",
           file.string(), row + 1, number, tetrahedra - 1);
    const Vec3 centre = centre_of_number(simulation.mesh(), number);
    if (!((list.centres[row] - centre).norm() <= kRounding))
      fail(
          "{}: is of another mesh: data row {} has the middle of tetrahedron {} at {} m, the mesh of this "
          "scene "
          "at {} m; make it again with this mesh: `sim_server record ... --removals FILE`",
          file.string(), row + 1, number, place_text(list.centres[row]), place_text(centre));
    if (!simulation.resection()->remaining().is_removable(number))
      fail(
          "{}: data row {} names tetrahedron {}, which the scene's [cutting] does not let go; is it of "
          "another scene?",
          file.string(), row + 1, number);
  }
}

Json resection_report(const Simulation& simulation) {
  const Resection* const resection = simulation.resection();
  if (resection == nullptr) return nullptr;
  const ResectionTotals& all = resection->totals();
  const FromPlan away(all, resection->has_plan());
  const auto known = [](const std::optional<double>& metres) { return metres ? Json(*metres) : Json(); };
  return {{"tetrahedra", all.tetrahedra},
          {"tetrahedra_remaining", resection->remaining().count()},
          {"removed_m3", all.volume},
          {"dropped_m3", all.dropped_volume},
          {"pieces_dropped", all.dropped_pieces},
          {"pieces_loose", all.loose_pieces},
          {"loose_m3", all.loose_volume},
          {"cut_area_m2", all.cut_area},
          {"mean_distance_m", known(away.mean)},
          {"furthest_m", known(away.furthest)},
          {"heat_J", all.heat},
          {"elastic_J", all.elastic},
          {"kinetic_J", all.kinetic},
          {"momentum_Ns", {all.momentum.x(), all.momentum.y(), all.momentum.z()}},
          {"separated_m2", all.separated_area},
          {"mean_separated_distance_m", known(away.mean_separated)},
          {"vertices_slid", all.slides},
          {"vertices_split", all.splits},
          {"ran_out_of_vertices", all.ran_out},
          {"outrun_steps", all.outrun_steps},
          {"hot_s", all.hot_time},
          {"contact_s", all.contact_time},
          {"at_end_s", all.time_at_end}};
}

std::string resection_text(const Simulation& simulation) {
  const Resection* const resection = simulation.resection();
  if (resection == nullptr) return {};
  const ResectionTotals& all = resection->totals();
  const bool planned = resection->has_plan();
  return fmt::format(
      "removed {} of {} tetrahedra, {:.2f} ml, {:.2f} ml of them {} loose pieces; cut {:.1f} cm2{}; "
      "{} pieces lie loose{}{}",
      all.tetrahedra, all.tetrahedra + resection->remaining().count(), 1e6 * all.volume,
      1e6 * all.dropped_volume, all.dropped_pieces, 1e4 * all.cut_area,
      away(planned, all.furthest, "at most"), all.loose_pieces, heat_text(all, planned),
      separated_text(all, planned));
}

Option resection_option(std::optional<std::filesystem::path>& file) {
  return {"--resection", "Of a scene with [cutting]: write what was removed, step by step, to this CSV",
          &file};
}

}  // namespace palpate::sim
