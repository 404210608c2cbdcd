#include "sim_server/scene_file/read_scene.h"

#include <algorithm>
#include <cmath>

#include "common/config.h"
#include "common/error.h"
#include "common/log.h"
#include "common/units.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/scene_file/read_cutting.h"
#include "sim_server/scene_file/read_inclusions.h"
#include "sim_server/scene_file/read_parts.h"
#include "sim_server/scene_file/read_reach.h"

namespace palpate::sim {
namespace {

SupportMotion read_motion(const Config& config) {
  SupportMotion motion{};
  motion.direction = config.vector("direction", {-1e3, 1e3, "any length but 0"});
  if (!(motion.direction.norm() > 1e-6))
    fail("{}: `direction` needs a length above 0", config.where("direction"));
  motion.direction.normalize();
  motion.amplitude = config.number("amplitude", {0, 1, "m"});
  motion.period = config.number("period", {0.01, 1e4, "s"});
  motion.phase = config.number("phase", {-1e3, 1e3, "rad"}, motion.phase);
  config.reject_unknown();
  return motion;
}

FixedRegion read_fixed(const Config& config) {
  FixedRegion region{read_region(config, "[[fixed]]"), read_axes(config), {}};
  for (const Config& motion : config.tables("motion")) region.motions.push_back(read_motion(motion));
  config.reject_unknown();
  return region;
}

/// That a model is for the material of the scene. One that does not deform passes over a plain one.
void require_material_of(const Scene& scene, const DeformationModelRow& row) {
  if (!scene.material) return;
  const Material& material = *scene.material;
  const Materials needed = material.is_plain()    ? Materials::kPlain
                           : material.is_linear() ? Materials::kLinear
                                                  : Materials::kAny;
  const auto takes = [needed](const DeformationModelRow& m) { return m.materials >= needed; };
  if (takes(row)) return;
  if (!row.deforms()) {
    if (material.is_plain() && scene.inclusions.empty()) return;
    fail(
        "{}: model \"{}\" does not deform, by this law, element, fibres, inclusions or relaxation; for this "
        "material: {}",
        scene.material_where, row.name, models_that(takes));
  }
  const std::string_view also = row.materials == Materials::kLinear ? "" : ", element \"p1\", no fibres";
  fail("{}: model \"{}\" is for law \"linear\"{} and no relaxation; for this material: {}",
       scene.material_where, row.name, also, models_that(takes));
}

/// Refuses a body that nothing holds, unless the model could have it fly.
void require_flight(const Scene& scene) {
  if (scene.material && scene.material->law == ElasticLaw::kLinear)
    fail(
        "{}: no [[fixed]] holds the body, and law \"linear\" is for small turns: add a [[fixed]], or take "
        "law "
        "\"corotational\", by which it flies",
        scene.source);
  for (const ToolSettings& tool : scene.tools) {
    if (tool.reach)
      fail("{}: no [[fixed]] holds the body, so that all of it comes within reach; remove this",
           tool.reach_where);
  }
}

/// That the model does what the scene asks of it.
void require_what_the_model_can(const Scene& scene) {
  const auto& settings = scene.deformation;
  const DeformationModelRow& row = model_of(settings);
  const auto any = [](const DeformationModelRow& m) { return m.materials == Materials::kAny; };
  if (!scene.loads.empty() && !any(row))
    fail("{}: [[load]]: model \"{}\" bears tools only; {} would, or `sim_server solve`",
         scene.loads.front().region.where, settings.model, models_that(any));
  require_material_of(scene, row);
  for (const Load& load : scene.loads) {
    if (load.kind == Load::Kind::kDisplacement && load.axes != kAllAxes)
      fail("{}: [[load]]: `axes`: only `sim_server solve` moves vertices along some axes; remove it",
           load.region.where);
  }
  for (const FixedRegion& region : scene.fixed) {
    if (region.axes != kAllAxes)
      fail("{}: `axes`: only `sim_server solve` holds vertices along some axes; remove it", region.where);
    if (region.moves() && !row.deforms())
      fail("{}: [[fixed.motion]]: model \"{}\" does not move with its supports; {} do", region.where,
           settings.model, models_that([](const DeformationModelRow& m) { return m.deforms(); }));
  }
}

/// That what is to be cut has a tool that cuts, a model that can bear it, and the other way round.
void require_cutting(const Scene& scene) {
  const auto cuts = [](const ToolSettings& tool) { return tool.cut_buttons != 0; };
  const auto cutter = std::ranges::find_if(scene.tools, cuts);
  if (cutter != scene.tools.end() && !scene.cutting)
    fail("{}: `cut_buttons`: the scene has no [cutting] that says how; add one, or remove this",
         cutter->cut_where);
  if (!scene.cutting && model_of(scene.deformation).needs_cutting)
    fail(
        "{}: model \"{}\" moves what [cutting] says can be cut, and the scene has none; add one, or take "
        "another model that can be cut ({})",
        scene.deformation.where, scene.deformation.model,
        models_that([](const DeformationModelRow& m) { return m.cuts && !m.needs_cutting; }));
  if (!scene.cutting) return;
  if (cutter == scene.tools.end())
    fail("{}: no [[tool]] cuts; give one `cut_buttons`, such as 1", scene.cutting->where);
  const DeformationModelRow& row = model_of(scene.deformation);
  if (!row.cuts)
    fail("{}: tissue of model \"{}\" cannot be cut; {} can", scene.cutting->where, row.name,
         models_that([](const DeformationModelRow& m) { return m.cuts; }));
  if (scene.material && scene.material->element != ElementKind::kLinear)
    fail("{}: tissue of element \"{}\" cannot be cut; take \"p1\"", scene.material_where,
         name_of(scene.material->element));
  if (!scene.loads.empty())
    fail("{}: [[load]]: tissue that is cut cannot bear loads besides tools yet; remove it, or [cutting]",
         scene.loads.front().region.where);
  const auto moves = std::ranges::find_if(scene.fixed, &FixedRegion::moves);
  if (moves != scene.fixed.end())
    fail("{}: [[fixed.motion]]: what is cut cannot move with its supports yet; remove it, or [cutting]",
         moves->where);
}

void warn_of_locking(const Scene& scene) {
  if (!scene.material || !scene.material->locks()) return;
  log::warning(
      "{}: element \"p1\" locks at poisson_ratio {:g}: it is too stiff, the more the nearer to 0.5 (by half "
      "at 0.499, ten times at 0.4999); take element \"p2\", or \"p1_nodal_pressure\" where little bends",
      scene.material_where, scene.material->poisson_ratio);
}

/// Soft tissue is about as dense as water, whatever else may be meant by a number.
void warn_of_density(const Scene& scene) {
  constexpr double kLeast = 100, kMost = 5000;  // kg/m3
  if (!scene.material || (scene.material->density >= kLeast && scene.material->density <= kMost)) return;
  const double density = scene.material->density, in_grams = 1000 * density;  // of 1 g/cm3
  const bool grams = in_grams >= kLeast && in_grams <= kMost;
  log::warning(
      "{}: `density` = {:g} kg/m3, and soft tissue has about 1060; {}", scene.material_where, density,
      grams ? fmt::format("if it is in g/cm3, write `density = {:g}`", in_grams) : "give it in kg/m3");
}

/// Fat and brain have some hundred pascals, bone ten gigapascals.
void warn_of_stiffness(const Scene& scene) {
  constexpr double kLeast = 100, kMost = 1e9;  // Pa
  if (!scene.material) return;
  const double modulus = scene.material->young_modulus;
  if (modulus >= kLeast && modulus <= kMost) return;
  log::warning("{}: young_modulus {:g} Pa is {} than any soft tissue has; is it in {}? 1 kPa is 1e3",
               scene.material_where, modulus, modulus < kLeast ? "less" : "more",
               modulus < kLeast ? "kPa" : "other units than Pa");
}

void read_grasp(const Config& config, ToolSettings& tool) {
  if (config.has("grasp_buttons")) {
    tool.grasp_buttons =
        static_cast<std::uint16_t>(config.integer("grasp_buttons", {1, 65535, "button bits"}));
    tool.grasp_where = config.where("grasp_buttons");
  }
  if (!config.has("grasp_place")) return;
  tool.grasp_place = config.vector("grasp_place", {.unit = "m"});
  if (tool.grasp_buttons != 0)
    fail("{}: a tool grasps by `grasp_buttons` or always, from `grasp_place` on; remove one",
         config.where("grasp_place"));
  tool.grasp_where = config.where("grasp_place");
}

/// Reads what else a shape needs; what belongs to another is an unknown key.
void read_shape(const Config& config, Tool& tool) {
  const std::string shape = config.text("shape", "sphere");
  if (shape == "sphere") return;
  if (shape == "capsule") {
    tool.length = config.number("length", {1e-4, 0.5, "m"});
  } else if (shape == "trocar") {
    Tool::Trocar trocar;
    trocar.pivot_W = config.vector("pivot", {-kMaxCoordinate, kMaxCoordinate, "m"});
    trocar.shaft_radius =
        config.number("shaft_radius", {1e-5, 0.05, "m"}, std::min(trocar.shaft_radius, tool.radius));
    if (trocar.shaft_radius > tool.radius)
      fail("{}: `shaft_radius` {:g} is more than `radius` {:g}, that of the tip",
           config.where("shaft_radius"), trocar.shaft_radius, tool.radius);
    tool.trocar = trocar;
  } else {
    fail("{}: unknown shape \"{}\"; known: sphere, capsule, trocar", config.where("shape"), shape);
  }
}

void read_blade(const Config& config, ToolSettings& tool) {
  if (!config.has("blade")) return;
  tool.blade_where = config.where("blade");
  tool.blade = config.vector("blade", {-0.5, 0.5, "m"});
  if (!(tool.blade->norm() >= 1e-4))
    fail("{}: `blade` is the end of the edge as seen from the centre of the tip, 0.1 mm away at least",
         tool.blade_where);
  if (tool.cut_buttons == 0)
    fail("{}: `blade`: nothing makes it cut; give this [[tool]] `cut_buttons`, such as 1", tool.blade_where);
}

ToolSettings read_tool(const Config& config) {
  ToolSettings tool;
  tool.where = config.where();
  tool.shape.radius = config.number("radius", {1e-5, 0.05, "m"}, tool.shape.radius);
  tool.shape.friction = config.number("friction", {0, 10, "no unit"}, tool.shape.friction);
  read_shape(config, tool.shape);
  read_reach(config, tool);
  read_grasp(config, tool);
  if (config.has("cut_buttons")) {
    tool.cut_buttons = static_cast<std::uint16_t>(config.integer("cut_buttons", {1, 65535, "button bits"}));
    tool.cut_where = config.where("cut_buttons");
  }
  read_blade(config, tool);
  config.reject_unknown();
  return tool;
}

/// The organ comes nearer by as much as its supports move, or are put elsewhere.
void reach_what_moves(Scene& scene) {
  double furthest = 0;
  for (const FixedRegion& region : scene.fixed) {
    double own = 0;
    for (const SupportMotion& motion : region.motions) own += motion.amplitude;
    furthest = std::max(furthest, own);
  }
  double put = 0;  // by displacements, which hold besides
  for (const Load& load : scene.loads) {
    if (load.kind == Load::Kind::kDisplacement) put = std::max(put, load.vector.norm());
  }
  furthest += put;
  for (ToolSettings& tool : scene.tools) {
    if (tool.reach && furthest > 0) tool.reach = widened(*tool.reach, furthest);
  }
}

std::vector<ToolSettings> read_tools(const Config& config) {
  const auto sections = config.tables("tool");
  if (sections.empty()) fail("{}: a scene needs a [[tool]]; add one with its `radius`", config.where());
  if (sections.size() > kMaxTools)
    fail("{}: a scene has at most {} [[tool]], this one has {}; remove some", sections[kMaxTools].where(),
         kMaxTools, sections.size());
  std::vector<ToolSettings> tools;
  for (const Config& section : sections) tools.push_back(read_tool(section));
  return tools;
}

/// The client files made for the scene.
std::vector<std::filesystem::path> read_clients(const Config& config) {
  std::vector<std::filesystem::path> clients = config.files("clients");
  for (const std::filesystem::path& client : clients) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(client, ignored))
      fail("{}: `clients`: {}: no such file", config.where("clients"), client.string());
  }
  config.reject_unknown();
  return clients;
}

void read_rate(const Config& config, Scene& scene) {
  scene.rate_hz = config.number("rate_hz", {0, 10000, "Hz"}, scene.rate_hz);
  if (config.has("rate_hz")) scene.rate_where = config.where("rate_hz");
  if (scene.rate_hz > 0 && scene.rate_hz < 1)
    fail("{}: `rate_hz` must be 0 or from 1 to 10000 Hz", config.where("rate_hz"));
}

/// `[mesh]`, and whether its file is there.
void read_mesh_section(const Config& mesh, Scene& scene) {
  scene.mesh_file = mesh.file("file");
  scene.mesh_where = mesh.where("file");
  scene.mesh_scale = mesh.number("scale", {1e-6, 1e3, "m per unit of the file"}, scene.mesh_scale);
  scene.mesh_refinements = mesh.number("refine", {0, 2, "times"}, 0);
  if (2 * scene.mesh_refinements != std::floor(2 * scene.mesh_refinements))
    fail("{}: `[mesh] refine` must be 0, 0.5, 1, 1.5 or 2 times", mesh.where("refine"));
  mesh.reject_unknown();
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(scene.mesh_file, ignored)) {
    fail("{}: `[mesh] file`: {}: {}", mesh.where("file"), scene.mesh_file.string(),
         std::filesystem::is_directory(scene.mesh_file, ignored) ? "a folder, not a mesh" : "no such file");
  }
}

/// `[material]` with its inclusions.
void read_tissue(const Config& material, Scene& scene) {
  scene.inclusions = read_inclusions(material);
  scene.material = read_material(material);
  scene.material_where = material.where();
  if (!scene.inclusions.empty() && scene.material->element == ElementKind::kNodalPressure)
    fail(
        "{}: [[material.inclusion]]: element \"p1_nodal_pressure\" averages over tissue of one stiffness; "
        "take "
        "\"p1\" or \"p2\"",
        scene.inclusions.front().where);
}

}  // namespace

Scene read_scene(const std::filesystem::path& file, Purpose purpose) {
  const Config config = Config::read(file);
  Scene scene;
  scene.source = file.string();
  scene.title = config.text("title", file.stem().string());
  read_rate(config, scene);
  const auto mesh = config.table("mesh");
  if (!mesh &&
      (config.has("device") || config.has("operator") || config.has("trajectory") || config.has("server")))
    fail("{}: is a client file, for `haptic_client run`; a scene has [mesh] and [deformation]",
         config.where());
  if (!mesh) fail("{}: missing section [mesh] with `file`", config.where());
  read_mesh_section(*mesh, scene);
  for (const Config& fixed : config.tables("fixed")) scene.fixed.push_back(read_fixed(fixed));
  for (const Config& load : config.tables("load")) scene.loads.push_back(read_load(load));
  if (const auto material = config.table("material")) read_tissue(*material, scene);
  const auto deformation = config.table("deformation");
  if (!deformation && purpose == Purpose::kServe)
    fail("{}: missing section [deformation] with `model`", config.where());
  if (deformation) scene.deformation = read_deformation(*deformation);
  if (purpose == Purpose::kServe) require_what_the_model_can(scene);
  if (purpose == Purpose::kServe || !config.tables("tool").empty()) scene.tools = read_tools(config);
  if (const auto cutting = config.table("cutting")) scene.cutting = read_cutting(*cutting);
  if (purpose == Purpose::kServe) require_cutting(scene);
  if (purpose == Purpose::kServe && scene.flies() && model_of(scene.deformation).flies) require_flight(scene);
  if (const auto session = config.table("session")) scene.clients = read_clients(*session);
  config.reject_unknown();
  reach_what_moves(scene);
  warn_of_locking(scene);
  warn_of_density(scene);
  warn_of_stiffness(scene);
  return scene;
}

}  // namespace palpate::sim
