#include "sim_server/scene_file/read_parts.h"

#include <algorithm>
#include <array>

#include "common/error.h"
#include "common/text.h"
#include "common/units.h"

namespace palpate::sim {
namespace {

template <class Value>
struct Named {
  std::string_view name;
  Value value;
};
template <class Value>
Named(const char*, Value) -> Named<Value>;
constexpr std::array kLaws{
    Named{"linear", ElasticLaw::kLinear},
    Named{"corotational", ElasticLaw::kCorotational},
    Named{"neo_hookean", ElasticLaw::kNeoHookean},
    Named{"stvk", ElasticLaw::kStVenantKirchhoff},
};
// Key `element` of [material].
constexpr std::array kElements{
    Named{"p1", ElementKind::kLinear},
    Named{"p1_nodal_pressure", ElementKind::kNodalPressure},
    Named{"p2", ElementKind::kQuadratic},
};

template <class Table, class Value>
std::string_view name_in(const Table& table, Value value) {
  return std::ranges::find_if(table, [&](const auto& row) { return row.value == value; })->name;
}

template <class Table>
auto values_of(const Table& table) {
  std::vector<std::remove_cvref_t<decltype(table[0].value)>> values;
  for (const auto& row : table) values.push_back(row.value);
  return values;
}

Fibres read_fibres(const Config& config) {
  Fibres fibres{config.vector("direction", {-1e3, 1e3, "any length but 0"}),
                config.number("modulus", {1e-3, 1e12, "Pa"})};
  if (!(fibres.direction.norm() > 1e-6))
    fail("{}: `direction` needs a length above 0", config.where("direction"));
  fibres.direction.normalize();
  config.reject_unknown();
  return fibres;
}

std::vector<Relaxation> read_relaxations(const Config& material) {
  std::vector<Relaxation> relaxations;
  double fractions = 0;
  for (const Config& section : material.tables("relaxation")) {
    relaxations.push_back({section.number("fraction", {1e-6, 0.999999, "of the stress at once"}),
                           section.number("time", {1e-4, 1e6, "s"})});
    section.reject_unknown();
    fractions += relaxations.back().fraction;
    if (fractions > 0.999999)
      fail(
          "{}: the fractions of all [[material.relaxation]] are {:g} together; less than 1 leaves some "
          "stress",
          section.where("fraction"), fractions);
  }
  return relaxations;
}

}  // namespace

Region read_region(const Config& config, const std::string& section) {
  Region region;
  region.where = config.where();
  if (config.has("box")) {
    const auto [min, max] = config.box("box");
    region.box = Box{min, max};
  }
  region.surface_tag = config.text("surface_tag", "");
  if (config.has("center") || config.has("radius"))
    region.ball =
        Ball{config.vector("center", {.unit = "m"}), config.number("radius", {1e-9, kMaxCoordinate, "m"})};
  const int given = region.box.has_value() + region.ball.has_value() + !region.surface_tag.empty();
  if (given != 1)
    fail("{}: {} needs one of `box`, `surface_tag`, or `center` with `radius`, and has {}", region.where,
         section, given == 0 ? "none" : "more");
  return region;
}

HeldAxes read_axes(const Config& config) {
  constexpr std::string_view kNames = "xyz";
  int axes = 0;
  for (const char c : config.text("axes", std::string(kNames))) {
    const auto axis = kNames.find(c);
    if (axis == std::string_view::npos)
      fail("{}: `axes` is some of x, y, z, as in \"xz\"; absent: all", config.where("axes"));
    axes |= 1 << axis;
  }
  if (axes == 0) fail("{}: `axes` holds along none; name some of x, y, z", config.where("axes"));
  return static_cast<HeldAxes>(axes);
}

Load read_load(const Config& config) {
  // What no body survives: some 1000 times gravity, the largest Young's modulus a scene may have, and such a
  // pressure on 10 cm2.
  constexpr double kFast = 1e4, kHard = 1e12, kStrong = 1e9;  // m/s2, Pa, N
  Load load{};
  int kinds = 0;
  const auto vector = [&](const char* key, Load::Kind kind, double most, const char* unit) {
    if (!config.has(key)) return;
    load.kind = kind;
    load.vector = config.vector(key, {-most, most, unit});
    ++kinds;
  };
  vector("gravity", Load::Kind::kGravity, kFast, "m/s2");
  vector("traction", Load::Kind::kTraction, kHard, "Pa");
  vector("force", Load::Kind::kForce, kStrong, "N");
  vector("displacement", Load::Kind::kDisplacement, kMaxCoordinate, "m");
  if (config.has("pressure")) {
    load.kind = Load::Kind::kPressure;
    load.pressure = config.number("pressure", {-kHard, kHard, "Pa"});
    ++kinds;
  }
  if (kinds != 1) {
    fail("{}: [[load]] needs one of `gravity`, `traction`, `pressure`, `force`, `displacement`, and has {}",
         config.where(), kinds == 0 ? "none" : "more; another [[load]] takes the rest");
  }
  if (load.kind == Load::Kind::kDisplacement) load.axes = read_axes(config);
  if (load.kind != Load::Kind::kGravity) load.region = read_region(config, "[[load]]");
  load.region.where = config.where();
  config.reject_unknown();
  return load;
}

std::string_view name_of(ElasticLaw law) {
  return name_in(kLaws, law);
}

std::string_view name_of(ElementKind element) {
  return name_in(kElements, element);
}

std::vector<ElasticLaw> elastic_laws() {
  return values_of(kLaws);
}

std::vector<ElementKind> element_kinds() {
  return values_of(kElements);
}

Material read_material(const Config& config) {
  Material material;
  material.law = find_row(kLaws, config.text("law", "linear"), "law", config.where("law")).value;
  material.element =
      find_row(kElements, config.text("element", "p1"), "element", config.where("element")).value;
  material.young_modulus = config.number("young_modulus", {1e-3, 1e12, "Pa"});
  // Below one half by more than rounding: lambda grows without bound there.
  material.poisson_ratio = config.number("poisson_ratio", {0, 0.499999, "below 0.5, no unit"});
  material.density = config.number("density", {1e-3, 1e5, "kg/m3"}, material.density);
  if (const auto fibres = config.table("fibres")) material.fibres = read_fibres(*fibres);
  material.relaxations = read_relaxations(config);
  config.reject_unknown();
  return material;
}

}  // namespace palpate::sim
