#include "sim_server/commands/explain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "common/error.h"
#include "common/progress.h"
#include "common/text.h"
#include "protocol/recorder.h"
#include "sim_server/explicit/mass_scaling.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/scene/touchable.h"
#include "sim_server/scene_file/read_scene.h"
#include "sim_server/simulation/error_of_force.h"
#include "sim_server/simulation/setup_times.h"
#include "sim_server/statics/compliance_tolerance.h"

namespace palpate::sim {
namespace {

constexpr double kLongSetUp = 1e4;             // ms: a scene whose variants are not built to compare
constexpr double kMostVariant = 2e9;           // bytes of compliance that a variant is built with
constexpr double kUsualFriction = 0.3;         // as in block_friction.toml
constexpr double kBytesOfMotion = 9 * 24 + 8;  // of a vertex in explicit steps: nine vectors, a mass
constexpr std::string_view kPressing = "pressing on both kinds of elements";  // a stage of set-up
/// The figures by which a variant is compared. `setup_ms` is without what all share: reading the mesh, and
/// presses on both kinds of elements.
struct Cost {
  double bytes = 0, setup_ms = 0, step_ms = 0;
};

/// Bytes that this process held resident at most so far, pages of its program too.
double peak_memory() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return 1024.0 * static_cast<double>(used.ru_maxrss);
}

double ms(Time t) {
  return 1e3 * to_seconds(t);
}

Cost cost_of(const Simulation& simulation, const SetupTimes& times, const StepTimes& steps) {
  Cost cost{0, ms(times.total() - times.of(name_of(Stage::kMesh)) - times.of(kPressing)),
            steps.contact_ns.quantile(0.5) / 1e6};
  for (const MemoryPart& part : simulation.memory()) cost.bytes += static_cast<double>(part.bytes);
  return cost;
}

/// Surface vertices whose compliance an elastic model of this scene keeps.
std::size_t loaded_nodes(const Scene& scene, const Simulation& simulation) {
  const std::vector<int> fixed = fixed_vertices(scene, simulation.mesh());
  const std::vector<int> all = reachable_vertices(simulation.surface(), simulation.mesh(), scene.tools);
  return static_cast<std::size_t>(std::ranges::count_if(
      all, [&](int v) { return !std::ranges::binary_search(fixed, simulation.surface().vertices[v]); }));
}

/// Returns the bytes by formula; 0 for a scene that has no elastic tissue.
double compliance_bytes(const Scene& scene, const Simulation& simulation) {
  if (!model_of(scene.deformation).keeps_compliance()) return 0;
  return scene.deformation.of<ComplianceTolerance>().bytes(loaded_nodes(scene, simulation));
}

/// The tool whose contact is called `part`, or null.
const ToolSettings* tool_of(const Scene& scene, const std::string& part) {
  for (std::size_t i = 0; i < scene.tools.size(); ++i) {
    if (part == contact_part(i, scene.tools.size())) return &scene.tools[i];
  }
  return nullptr;
}

std::string where_of(const Scene& scene, const std::string& part) {
  if (const ToolSettings* tool = tool_of(scene, part)) return tool->where;
  if (part == "mesh") return scene.mesh_where;
  if (part == "surface") return "always";
  if (part == "resection") return scene.cutting->where;
  return scene.deformation.where;
}

std::string shape_of(const Tool& tool) {
  if (tool.trocar) return fmt::format("trocar, shaft radius {:g} mm", 1e3 * tool.trocar->shaft_radius);
  return tool.is_sphere() ? "sphere" : fmt::format("capsule, length {:g} mm", 1e3 * tool.length);
}

/// True if the scene keeps a factor of what can be cut, to publish its surface anew.
bool keeps_factor(const Simulation& simulation) {
  return std::ranges::any_of(simulation.memory(),
                             [](const MemoryPart& part) { return part.name == "published surface"; });
}

std::string detail_of(const Scene& scene, const Simulation& simulation, const std::string& part) {
  const TetMesh& mesh = simulation.mesh();
  const Surface& surface = simulation.surface();
  if (part == "mesh")
    return fmt::format("{} vertices, {} tetrahedra", mesh.corners(), mesh.tetrahedra.size());
  if (part == "surface")
    return fmt::format("{} vertices, {} triangles", surface.vertices.size(), surface.triangles.size());
  if (part == "resection") {
    const CutMesh& remaining = simulation.resection()->remaining();
    std::size_t removable = 0;
    for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t) removable += remaining.is_removable(t);
    const auto [spare, end] = remaining.spares();
    return fmt::format("{} of {} tetrahedra can be removed; their vertices count to the surface{}", removable,
                       mesh.tetrahedra.size(),
                       end > spare ? fmt::format(", with {} more that a blade may need", end - spare) : "");
  }
  if (part == "compliance") return fmt::format("{} nodes", loaded_nodes(scene, simulation));
  if (part == "stiffness matrix" || part == "its factor")
    return keeps_factor(simulation)                         ? "kept: part of the published surface"
           : model_of(scene.deformation).keeps_compliance() ? "freed after set-up"
                                                            : "kept: part of motion";
  if (const ToolSettings* tool = tool_of(scene, part)) {
    const std::size_t reached = reachable_vertices(surface, mesh, {tool, 1}).size();
    return fmt::format(
        "{}, radius {:g} mm{}, reaches {} nodes{}", shape_of(tool->shape), 1e3 * tool->shape.radius,
        tool->shape.friction > 0 ? fmt::format(", friction {:g}", tool->shape.friction) : "", reached,
        !tool->reach   ? ": all"
        : reached == 0 ? ": no collision tree"
                       : "");
  }
  return {};
}

/// The part that a stage of set-up makes.
std::string part_of(const std::string& stage, std::size_t tools) {
  for (std::size_t i = 0; i < tools; ++i) {
    if (stage == contact_stage(i, tools)) return contact_part(i, tools);
  }
  const auto row = std::ranges::find(kStages, stage, &StageRow::name);
  return row == kStages.end() ? stage : std::string(row->part);
}

/// The row called `name`, new at the end if it is not there yet.
BuiltPart& row_of(std::vector<BuiltPart>& rows, const std::string& name, const Scene& scene,
                  const Simulation& simulation) {
  const auto found = std::ranges::find_if(rows, [&](const BuiltPart& r) { return r.part == name; });
  if (found != rows.end()) return *found;
  return rows.emplace_back(BuiltPart{name, detail_of(scene, simulation, name), where_of(scene, name)});
}

/// The row of the material, which keeps what tells the mesh's share of the error.
BuiltPart material_part(const Scene& scene, const ErrorOfForce& errors, double setup_ms) {
  BuiltPart row{"material", "not used", scene.material_where};
  if (!model_of(scene.deformation).deforms()) return row;
  row.detail = fmt::format(
      "kept: the error of the force by the mesh, {} presses on \"p1\" and \"p2\"{}{}", errors.presses(),
      errors.why_no_press().empty() ? "" : fmt::format(": {}", errors.why_no_press()),
      scene.material->locks() ? "; \"p1\" locks at this poisson_ratio: take \"p2\"" : "");
  row.bytes = errors.bytes();
  row.setup_ms = setup_ms;
  return row;
}

/// Parts in the order in which they are set up, then those that take no time of their own.
std::vector<BuiltPart> built_parts(const Scene& scene, const Simulation& simulation,
                                   const ErrorOfForce& errors, const SetupTimes& times) {
  std::vector<BuiltPart> rows;
  for (const SetupTimes::Stage& stage : times.stages()) {
    if (stage.name == kPressing) continue;
    row_of(rows, part_of(stage.name, scene.tools.size()), scene, simulation).setup_ms += ms(stage.took);
  }
  for (const MemoryPart& part : simulation.memory()) {
    BuiltPart& row = row_of(rows, part.name, scene, simulation);
    row.bytes = part.bytes;
    if (!part.detail.empty()) row.detail = part.detail;
  }
  if (const double added = simulation.traits().added_mass; added > 0)
    rows.push_back({"added mass", added_mass_text(added), scene.deformation.where});
  const std::string wall =
      fmt::format("nothing kept; under a tool each vertex is a wall of {:g} N/m", held_stiffness(scene));
  for (const FixedRegion& region : scene.fixed) rows.push_back({"fixed", wall, region.where});
  if (scene.material) rows.push_back(material_part(scene, errors, ms(times.of(kPressing))));
  return rows;
}

/// The scene as it is, built and stepped: what its variants are compared with.
struct Own {
  const Scene& scene;
  const Progress& progress;
  int steps;  // timed free, and in contact
  const SetupCache* cache;
  const Condensed* condensed;
  Simulation simulation;
  std::vector<std::optional<Press>> sites;
  Cost cost;
  double compliance_ms = 0;  // of the set-up
};

/// Returns what setting up a variant would take, ms: compliance goes with the nodes that can be loaded.
double predicted_ms(const Scene& variant, const Own& own) {
  const auto nodes = [&](const Scene& scene) {
    return static_cast<double>(
        compliance_bytes(scene, own.simulation) > 0 ? loaded_nodes(scene, own.simulation) : 0);
  };
  const double more = nodes(own.scene) > 0 ? nodes(variant) / nodes(own.scene) - 1 : 0;
  return own.cost.setup_ms + std::max(more, 0.0) * own.compliance_ms;
}

/// Returns what `variant` costs more, built and stepped in the same way.
Omitted compare(Omitted row, const Scene& variant, const Own& own) {
  const double compliance = compliance_bytes(variant, own.simulation);
  if (compliance > kMostVariant) {
    row.bytes = compliance - compliance_bytes(own.scene, own.simulation);
    row.note = "not built: too large (bytes: computed)";
    return row;
  }
  if (predicted_ms(variant, own) > kLongSetUp) {
    row.note = "not measured: it would take long to set up";
    return row;
  }
  try {
    SetupTimes times(own.progress);
    TetMesh mesh = own.simulation.mesh();
    const Resection* const resection = own.simulation.resection();
    if (resection != nullptr && resection->remaining().spares().second > 0)  // it makes its own
      mesh.vertices.resize(static_cast<std::size_t>(resection->remaining().spares().first));
    Simulation simulation(variant, std::move(mesh), std::ref(times), own.cache, own.condensed);
    const Cost cost =
        cost_of(simulation, times, time_steps(variant, simulation, own.sites, own.steps, own.progress));
    row.bytes = cost.bytes - own.cost.bytes;
    row.setup_ms = cost.setup_ms - own.cost.setup_ms;
    row.step_ms = cost.step_ms - own.cost.step_ms;
    row.note = "measured";
  } catch (const Error& error) {
    row.note = fmt::format("cannot be built: {}", error.what());
  }
  return row;
}

/// Returns what no tool reaches; nothing where a tool reaches everything.
std::optional<Omitted> beyond_reach(const Own& own) {
  const auto& tools = own.scene.tools;
  if (!std::ranges::all_of(tools, [](const ToolSettings& tool) { return tool.reach.has_value(); })) return {};
  Scene variant = own.scene;
  for (ToolSettings& tool : variant.tools) tool.reach.reset();
  return compare({.what = "the surface out of reach", .why = tools.front().reach_where}, variant, own);
}

/// The simplest model that deforms: at rest at every instant.
Omitted elasticity(const Own& own) {
  const auto rows = deformation_models();
  const auto model =
      std::ranges::find_if(rows, [](const DeformationModelRow& m) { return m.deforms() && !m.moves; });
  Omitted row{.what = fmt::format("elasticity ({})", model->name), .why = own.scene.deformation.where};
  if (!own.scene.material || own.scene.fixed.empty()) {
    row.why = own.scene.material
                  ? "no [[fixed]] section"
                  : fmt::format("no [material]{} section", own.scene.fixed.empty() ? ", no [[fixed]]" : "");
    row.note = "not built: needs [material] and [[fixed]]";
    return row;
  }
  Scene variant = own.scene;
  variant.deformation.model = model->name;
  return compare(row, variant, own);
}

/// Returns the row of friction, of all tools; nothing where one has some.
std::optional<Omitted> friction(const Own& own) {
  Scene variant = own.scene;
  for (ToolSettings& tool : variant.tools) {
    if (tool.shape.friction > 0) return {};
    tool.shape.friction = kUsualFriction;
  }
  return compare({.what = fmt::format("friction ({:g})", kUsualFriction), .why = variant.tools.front().where},
                 variant, own);
}

/// The compliance of all free vertices, inside the organ and out of reach too.
Omitted total_compliance(const Own& own) {
  const TetMesh& mesh = own.simulation.mesh();
  const std::size_t free = mesh.vertices.size() - fixed_vertices(own.scene, mesh).size();
  const auto& settings = own.scene.deformation.of<ComplianceTolerance>();
  const ComplianceTolerance as_stored{settings.of(loaded_nodes(own.scene, own.simulation))};
  return {.what = "compliance of the other free vertices",
          .why = own.scene.deformation.where,
          .bytes = as_stored.bytes(free) - compliance_bytes(own.scene, own.simulation),
          .note = fmt::format("computed for all {} free vertices, less what is kept", free)};
}

/// Returns the row of motion, of a model at rest: what motion would hold.
Omitted motion(const Own& own) {
  const auto n = static_cast<double>(own.simulation.mesh().vertices.size());
  return {.what = "motion (mass, velocities)",
          .why = own.scene.deformation.where,
          .bytes = kBytesOfMotion * n,
          .note = fmt::format("computed: {:g} n; the model is at rest", kBytesOfMotion)};
}

/// Returns the row of cutting: a scene without it stores neither which tetrahedra touch nor the heat in them.
Omitted cutting(const Own& own) {
  const auto vertices = static_cast<double>(own.simulation.mesh().corners()),
             tetrahedra = static_cast<double>(own.simulation.mesh().tetrahedra.size()),
             faces = static_cast<double>(own.simulation.surface().triangles.size()) /
                     own.simulation.surface().per_face;
  return {.what = "cutting",
          .why = "no [cutting]",
          .bytes = Resection::estimated_bytes(vertices, tetrahedra, faces),
          .note = "computed: neighbours, faces and heat of each tetrahedron; a step looks at none of it"};
}

/// Returns what a step saves as long as no client's law asks for dF/dp.
Omitted tangents(Own& own) {
  const StepTimes without =
      time_steps(own.scene, own.simulation, own.sites, own.steps, own.progress, {.tangent = false});
  return {.what = "tangents",
          .why = "nobody, until a client's law subscribes",
          .step_ms = own.cost.step_ms - without.contact_ns.quantile(0.5) / 1e6,
          .note = "measured; the times below are with them"};
}

void add_unreached_tools(const Own& own, std::vector<Omitted>& rows) {
  for (std::size_t i = 0; i < own.scene.tools.size(); ++i) {
    const ToolSettings& tool = own.scene.tools[i];
    if (!tool.reach ||
        !reachable_vertices(own.simulation.surface(), own.simulation.mesh(), {&tool, 1}).empty())
      continue;
    rows.push_back({.what = fmt::format("collision tree of tool {}", i + 1),
                    .why = tool.reach_where,
                    .note = "it reaches no part of the surface"});
  }
}

std::vector<Omitted> omitted(Own& own) {
  std::vector<Omitted> rows;
  const DeformationModelRow& model = model_of(own.scene.deformation);
  if (const auto row = beyond_reach(own)) rows.push_back(*row);
  if (const auto row = friction(own)) rows.push_back(*row);
  if (!model.deforms() && !model.moves) rows.push_back(elasticity(own));
  if (model.keeps_compliance()) rows.push_back(total_compliance(own));
  if (!model.moves) rows.push_back(motion(own));
  if (model.unneeded && !keeps_factor(own.simulation))
    rows.push_back({.what = std::string(model.unneeded->what),
                    .why = own.scene.deformation.where,
                    .note = std::string(model.unneeded->note)});
  if (!own.scene.cutting) rows.push_back(cutting(own));
  add_unreached_tools(own, rows);
  rows.push_back(tangents(own));
  rows.push_back({.what = "recording",
                  .why = "sim_server run --record",
                  .bytes = static_cast<double>(protocol::Recorder::memory_bytes()),
                  .note = "computed; and a thread"});
  return rows;
}

}  // namespace

Explanation explain(const Scene& scene, const Progress& progress, int steps, const SetupCache* cache,
                    const Condensed* condensed) {
  SetupTimes times(progress);
  Own own{scene, progress, steps, cache, condensed, Simulation(scene, std::ref(times), cache, condensed),
          {},    {}};
  times(kPressing, 0);
  const ErrorOfForce errors(scene, own.simulation);
  times(kPressing, 1);
  own.sites = find_presses(scene, own.simulation);
  Explanation explanation{.scene = scene,
                          .built = built_parts(scene, own.simulation, errors, times),
                          .omitted = {},
                          .steps = time_steps(scene, own.simulation, own.sites, steps, progress),
                          .state_hash = own.simulation.state_hash(),
                          .tetrahedra = own.simulation.mesh().tetrahedra.size(),
                          .peak_bytes = peak_memory()};
  own.cost = cost_of(own.simulation, times, explanation.steps);
  own.compliance_ms = ms(times.of(name_of(Stage::kCompliance)));
  explanation.omitted = omitted(own);
  return explanation;
}

int run_explain(const ExplainOptions& options) {
  const Scene scene = read_scene(options.scene);
  require_distinct({{"SCENE", options.scene}, {"--json", options.json}});
  if (options.json) check_writable(*options.json, Contents::kReport);
  const auto cache = open_cache(options.cache);
  const auto condensed = open_condensed(options.cache, scene);
  const Explanation explanation = explain(scene, ProgressLine(), options.steps, cache ? &*cache : nullptr,
                                          condensed ? &*condensed : nullptr);
  fmt::print("{}", options.why ? why_text(explanation, *options.why) : to_text(explanation));
  if (options.json) write_json(*options.json, to_json(explanation));
  return 0;
}

}  // namespace palpate::sim
