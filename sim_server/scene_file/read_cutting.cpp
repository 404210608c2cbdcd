#include "sim_server/scene_file/read_cutting.h"

#include "common/error.h"
#include "sim_server/scene_file/read_parts.h"

namespace palpate::sim {
namespace {

CutPlan read_plan(const Config& config) {
  CutPlan plan;
  plan.point = config.vector("point", {.unit = "m"});
  plan.normal = config.vector("normal", {-1e3, 1e3, "any length but 0"});
  if (!(plan.normal.norm() > 1e-6)) fail("{}: `normal` needs a length above 0", config.where("normal"));
  plan.normal.normalize();
  if (config.has("within")) plan.within = config.number("within", {1e-6, 1, "m"});
  config.reject_unknown();
  return plan;
}

bool names_region(const Config& config) {
  return config.has("box") || config.has("center") || config.has("radius") || config.has("surface_tag");
}

}  // namespace

Cutting read_cutting(const Config& config) {
  Cutting cutting;
  cutting.where = config.where();
  cutting.power = config.number("power", {1e-6, 1e6, "W"}, cutting.power);
  cutting.energy = config.number("energy", {1e3, 1e12, "J/m^3"}, cutting.energy);
  cutting.spot = config.number("spot", {1e-6, 0.05, "m"}, cutting.spot);
  cutting.toughness = config.number("toughness", {0, 1e5, "J/m^2"}, cutting.toughness);
  cutting.smallest_piece = config.number("smallest_piece", {0, 1, "m^3"}, cutting.smallest_piece);
  if (names_region(config)) cutting.region = read_region(config, "[cutting]");
  if (const auto plan = config.table("plan")) cutting.plan = read_plan(*plan);
  config.reject_unknown();
  return cutting;
}

}  // namespace palpate::sim
