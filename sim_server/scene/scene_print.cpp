#include "sim_server/scene/scene_print.h"

#include "common/hash.h"

namespace palpate::sim {
namespace {

/// Hash of 32 bits of numbers and texts, never 0.
class Print {
 public:
  template <class... Numbers>
  void add(Numbers... numbers) {
    (add_number(static_cast<double>(numbers)), ...);
  }
  void add(const Vec3& v) { hash_.add(v); }
  void add(const std::string& text) {
    add(text.size());
    hash_.add(text.data(), text.size());
  }
  std::uint32_t value() const {
    const auto folded = static_cast<std::uint32_t>(hash_.value() ^ hash_.value() >> 32);
    return folded == 0 ? 1 : folded;
  }

 private:
  void add_number(double number) { hash_.add(&number, sizeof number); }
  Fnv1a hash_;
};

std::uint32_t print_of_mesh(const TetMesh& mesh) {
  Print print;
  for (const Tetrahedron& t : mesh.tetrahedra) {
    for (const int v : t) print.add(mesh.vertices[static_cast<std::size_t>(v)]);
  }
  return print.value();
}

std::uint32_t print_of_material(const Scene& scene, const TetMesh& mesh) {
  Print print;
  if (const auto& material = scene.material) {
    print.add(material->young_modulus, material->poisson_ratio, material->density,
              static_cast<int>(material->law), static_cast<int>(material->element));
    if (material->fibres) print.add(material->fibres->direction), print.add(material->fibres->modulus);
    for (const Relaxation& term : material->relaxations) print.add(term.fraction, term.time);
  }
  for (const double stiffness : mesh.stiffness) print.add(stiffness);
  if (const auto& cutting = scene.cutting)
    print.add(cutting->power, cutting->energy, cutting->spot, cutting->toughness, cutting->smallest_piece);
  return print.value();
}

void add_reach(const Reach& reach, Print& print) {
  print.add(reach.index());
  if (const auto* box = std::get_if<Box>(&reach)) print.add(box->min), print.add(box->max);
  if (const auto* cone = std::get_if<Cone>(&reach)) {
    print.add(cone->apex), print.add(cone->axis);
    print.add(cone->half_angle, cone->depth, cone->around);
  }
}

void add_region(const Region& region, Print& print) {
  print.add(region.surface_tag);
  if (region.box) print.add(region.box->min), print.add(region.box->max);
  if (region.ball) print.add(region.ball->center), print.add(region.ball->radius);
}

std::uint32_t print_of_supports(const Scene& scene) {
  Print print;
  for (const FixedRegion& fixed : scene.fixed) {
    add_region(fixed, print);
    print.add(static_cast<int>(fixed.axes));
    for (const SupportMotion& motion : fixed.motions) {
      print.add(motion.direction);
      print.add(motion.amplitude, motion.period, motion.phase);
    }
  }
  for (const Load& load : scene.loads) {
    add_region(load.region, print);
    print.add(load.vector);
    print.add(static_cast<int>(load.kind), static_cast<int>(load.axes), load.pressure);
  }
  return print.value();
}

std::uint32_t print_of_tools(const Scene& scene, const std::string& body) {
  Print print;
  print.add(scene.deformation.model);
  print.add(body);
  for (const ToolSettings& tool : scene.tools) {
    print.add(tool.shape.radius, tool.shape.friction, tool.shape.length);
    if (const auto& trocar = tool.shape.trocar) print.add(trocar->pivot_W), print.add(trocar->shaft_radius);
    if (tool.blade) print.add(*tool.blade);
    if (tool.reach) add_reach(*tool.reach, print);
    if (tool.grasp_place) print.add(*tool.grasp_place);
    print.add(tool.grasp_buttons, tool.cut_buttons);
  }
  return print.value();
}

}  // namespace

protocol::ScenePrint print_of(const Scene& scene, const TetMesh& mesh, const std::string& body) {
  return {.mesh = print_of_mesh(mesh),
          .material = print_of_material(scene, mesh),
          .supports = print_of_supports(scene),
          .tools = print_of_tools(scene, body)};
}

}  // namespace palpate::sim
