#include "sim_server/simulation/element_trial.h"

#include <algorithm>
#include <fmt/core.h>
#include <functional>
#include <new>

#include "common/error.h"
#include "sim_server/mesh/bounding_box.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/scene/touchable.h"
#include "sim_server/simulation/step_times.h"

namespace palpate::sim {
namespace {

constexpr int kMostNodes = 6000;    // of quadratic elements: their factor takes about a second
constexpr std::size_t kPlaces = 4;  // each adds a reach to the compliance of quadratic elements
constexpr int kMostInReach =
    300;                          // vertices, of all places: quadratic elements have four times as many nodes
constexpr double kSpread = 0.25;  // of the diagonal of the reach: how far from each other the places are
constexpr double kAcross = 0.5;   // cosine between normals of places that may be nearer
constexpr double kAround = 1.1;   // radii around the tool: it presses straight down
constexpr double kSmooth = 0.75;  // cosine between the normals of a vertex and of each of its faces
constexpr double kStep = 1;       // s: tissue at rest takes any

/// The same tissue at rest, of the linear law, under the first tool alone.
Scene at_rest(Scene scene) {
  const auto rests = [](const DeformationModelRow& row) {
    return row.deforms() && !row.moves && !row.needs_cutting;
  };
  scene.deformation = {};
  scene.deformation.model = std::ranges::find_if(deformation_models(), rests)->name;
  scene.material->law = ElasticLaw::kLinear;
  scene.material->relaxations.clear();
  scene.loads.clear();
  for (FixedRegion& fixed : scene.fixed) fixed.motions.clear();
  scene.tools.resize(1);
  return scene;
}

/// Touchable surface vertices that do not lie on a sharp edge, where a press slips and twists; all of them
/// where there are no others.
std::vector<int> smooth_vertices(const Simulation& simulation, std::span<const Vec3> normals) {
  std::vector<int> vertices = vertices_of({{simulation.touchable(0).begin(), simulation.touchable(0).end()}});
  std::vector<char> sharp(normals.size(), 0);
  for (const Triangle& t : simulation.surface().triangles) {
    const auto at = [&](int k) -> const Vec3& { return simulation.rest()[static_cast<std::size_t>(t[k])]; };
    const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
    for (const int v : t) {
      if (normal.dot(normals[v]) < kSmooth) sharp[v] = 1;
    }
  }
  const auto is_smooth = [&](int v) { return sharp[v] == 0; };
  if (std::ranges::any_of(vertices, is_smooth)) std::erase_if(vertices, std::not_fn(is_smooth));
  return vertices;
}

/// From the vertex that yields most along its normal to the one that yields least.
void sort_by_compliance(std::vector<int>& vertices, const Simulation& simulation,
                        std::span<const Vec3> normals) {
  std::vector<double> yields(normals.size());
  ContactPatch patch;
  patch.reserve(1, 1);
  for (const int v : vertices) {
    simulation.model().compliance(std::span(&v, 1), patch);
    const Mat3 compliance = patch.compliance.block<3, 3>(0, 0);
    yields[v] = normals[v].dot(compliance * normals[v]);
  }
  std::ranges::stable_sort(vertices, std::greater(), [&](int v) { return yields[v]; });
}

/// What a tool at a place can touch.
Box around(const Press& place, double radius) {
  const Vec3 margin = Vec3::Constant(kAround * radius);
  return {place.place - margin, place.place + margin};
}

/// Leaves as many of the first places as contact of quadratic elements has memory and time for: with a tool
/// that is large against the organ each reaches all of it.
void bound_reach(std::vector<Press>& places, const Simulation& linear, double radius) {
  std::ptrdiff_t in_reach = 0;
  const auto is_too_much = [&](const Press& place) {
    const Box box = around(place, radius);
    in_reach += std::ranges::count_if(linear.rest(), [&](const Vec3& x) { return box.contains(x); });
    return in_reach > kMostInReach;
  };
  places.erase(std::ranges::find_if(places, is_too_much), places.end());
}

/// The vertex nearest to the middle of these.
int middle_of(std::span<const int> vertices, const Simulation& simulation) {
  const auto at = [&](int v) -> const Vec3& { return simulation.rest()[static_cast<std::size_t>(v)]; };
  Vec3 middle = Vec3::Zero();
  for (const int v : vertices) middle += at(v) / static_cast<double>(vertices.size());
  return *std::ranges::min_element(vertices, {}, [&](int v) { return (at(v) - middle).squaredNorm(); });
}

/// The middle of the reach, then the places that yield most, apart or across each other.
std::vector<Press> places_to_press(const Scene& scene, const Simulation& linear) {
  const std::vector<Vec3> normals = normals_at_rest(linear);
  std::vector<int> vertices = smooth_vertices(linear, normals);
  const auto at = [&](int v) -> const Vec3& { return linear.rest()[static_cast<std::size_t>(v)]; };
  const int middle = middle_of(vertices, linear);
  std::vector<Press> places{press_on(at(middle), normals[middle], scene.tools[0].shape.radius)};
  sort_by_compliance(vertices, linear, normals);
  std::vector<Vec3> reach;
  for (const int v : vertices) reach.push_back(at(v));
  const double apart = kSpread * diagonal_of(reach);
  for (const int v : vertices) {
    if (places.size() == kPlaces) break;
    const Press place = press_on(at(v), normals[v], scene.tools[0].shape.radius);
    const auto is_near = [&](const Press& other) {
      return (other.place - place.place).norm() < apart && std::abs(other.normal.dot(place.normal)) > kAcross;
    };
    if (std::ranges::none_of(places, is_near)) places.push_back(place);
  }
  return places;
}

/// The force on a tool that comes to `site` from above it, the others lifted; nothing where the contact has
/// not settled.
std::optional<Vec3> press(Simulation& simulation, std::size_t tool, const Press& site, double radius) {
  std::vector<ToolInput> inputs(simulation.tools());
  inputs[tool].pose = ToolPose(site.place + 2 * radius * site.normal);
  inputs[tool].enters = true;
  simulation.step(inputs, kStep);
  inputs[tool] = {.pose = ToolPose(site.place)};
  const ToolForce force = simulation.step(inputs, kStep)[tool];
  if (force.flagged || force.contacts == 0) return {};
  return force.force;
}

/// Quadratic elements in reach of these places alone, each of a tool of its own: their compliance is dear.
Simulation quadratic_near(Scene scene, const TetMesh& mesh, std::span<const Press> places) {
  scene.material->element = ElementKind::kQuadratic;
  scene.tools.resize(places.size(), scene.tools[0]);
  for (std::size_t i = 0; i < places.size(); ++i)
    scene.tools[i].reach = around(places[i], scene.tools[0].shape.radius);
  return Simulation(scene, mesh);
}

ElementTrials press_both(const Scene& scene, const TetMesh& mesh) {
  const double radius = scene.tools[0].shape.radius;
  Simulation linear(scene, mesh);
  std::vector<Press> places = places_to_press(scene, linear);
  bound_reach(places, linear, radius);
  if (places.empty()) {
    return {
        {},
        fmt::format("the first [[tool]] reaches more than {} vertices at once, too many to press on \"p2\"; "
                    "take a smaller `radius` or a coarser mesh",
                    kMostInReach)};
  }
  Simulation quadratic = quadratic_near(scene, mesh, places);
  std::vector<ElementTrial> trials;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::optional<Vec3> by_linear = press(linear, 0, places[i], radius);
    const std::optional<Vec3> right = press(quadratic, i, places[i], radius);
    if (!by_linear || !right || right->isZero(0)) continue;
    const auto loads = linear.loads(0);
    trials.push_back({.percent = 100 * (*by_linear - *right).norm() / right->norm(),
                      .loads = {loads.begin(), loads.end()}});
  }
  if (trials.empty()) {
    return {
        {},
        fmt::format("contact settled at none of the {} places that were pressed; take a mesh with smaller "
                    "elements than the `radius` of the first [[tool]]",
                    places.size())};
  }
  return {std::move(trials), {}};
}

/// Returns why a scene is not pressed on; empty: it is.
std::string why_untried(const Scene& scene, const TetMesh& mesh) {
  if (scene.material->element != ElementKind::kLinear)
    return "they compare \"p1\" with \"p2\", and this scene does not have \"p1\"; nothing to change";
  if (scene.cutting)
    return "tissue that can be cut is not pressed on; explain a copy of the scene without [cutting]";
  if (scene.tools.front().grasps())
    return "the first [[tool]] holds tissue; list a [[tool]] that presses first";
  if (scene.flies()) return "nothing holds the organ in place; add a [[fixed]]";
  if (reachable_vertices(boundary_surface(mesh), mesh, std::span(scene.tools).first(1)).empty())
    return "the first [[tool]] reaches no surface; move its `reach` to where it presses";
  const MeshInfo info = describe(mesh);
  const auto nodes = info.vertices + info.edges;
  if (nodes <= kMostNodes) return {};
  return fmt::format(
      "\"p2\" would have {} nodes on this mesh, and up to {} are tried; take a coarser mesh, or "
      "measure with `sim_server study`",
      nodes, kMostNodes);
}

}  // namespace

ElementTrials try_elements(const Scene& scene, const TetMesh& mesh) {
  if (std::string why = why_untried(scene, mesh); !why.empty()) return {{}, std::move(why)};
  try {
    return press_both(at_rest(scene), mesh);
  } catch (const Error& error) {  // nothing is known then, as without a trial
    return {{}, fmt::format("tissue at rest cannot be set up: {}", error.what())};
  } catch (const std::bad_alloc&) {
    return {{}, "memory is short; take a coarser mesh"};
  }
}

}  // namespace palpate::sim
