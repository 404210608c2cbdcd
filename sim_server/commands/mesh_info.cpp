#include "sim_server/commands/mesh_info.h"

#include <fmt/core.h>
#include <memory>

#include "common/log.h"
#include "common/units.h"
#include "sim_server/mesh/gmsh_io.h"

namespace palpate::sim {
namespace {

void print_sizes(const TetMesh& mesh) {
  const MeshInfo info = describe(mesh);
  const Vec3 size = info.max - info.min;
  fmt::print("  vertices            {}\n  edges               {}\n  tetrahedra          {}\n", info.vertices,
             info.edges, info.tetrahedra);
  fmt::print("  boundary vertices   {}\n  boundary triangles  {}\n", info.boundary_vertices,
             info.boundary_triangles);
  fmt::print("  volume              {:.6g} m3 ({:.4g} litres)\n", info.volume, 1e3 * info.volume);
  fmt::print("  size                {:.4g} x {:.4g} x {:.4g} m\n", size[0], size[1], size[2]);
  fmt::print("  box                 [[{:.4g}, {:.4g}, {:.4g}], [{:.4g}, {:.4g}, {:.4g}]] m\n", info.min[0],
             info.min[1], info.min[2], info.max[0], info.max[1], info.max[2]);
  fmt::print("  edge length         {:.4g} / {:.4g} / {:.4g} mm (min, median, max)\n", 1e3 * info.min_edge,
             1e3 * info.median_edge, 1e3 * info.max_edge);
  fmt::print(
      "  dihedral angles     {:.2f} to {:.2f} degrees; median of the smallest per tetrahedron {:.2f}\n",
      info.min_dihedral / kDegree, info.max_dihedral / kDegree, info.median_min_dihedral / kDegree);
  if (const std::string odd = odd_size(mesh); !odd.empty()) log::warning("{}", odd);
}

/// The groups of the file: a scene names those of the surface (`surface_tag`).
void print_groups(const TetMesh& mesh) {
  for (const auto& [name, triangles] : mesh.tagged_triangles)
    fmt::print("  surface_tag         \"{}\": {} triangles\n", name, triangles.size());
  for (const auto& [name, tetrahedra] : mesh.volume_tags)
    fmt::print("  group of volumes    \"{}\": {} tetrahedra; a scene takes them by a box or ball\n", name,
               tetrahedra);
}

void print_faults(const MeshFaults& faults) {
  if (faults.found.empty()) fmt::print("  faults              none\n");
  for (const MeshFault& fault : faults.found) {
    const char* cure = fault.cure == Cure::kMended     ? "mended"
                       : fault.cure == Cure::kAccepted ? "accepted"
                                                       : "refused";
    fmt::print("  {:<20}{} ({}): {}{}{}\n", cure, fault.kind, fault.count, fault.example,
               fault.remedy.empty() ? "" : "; ", fault.remedy);
  }
  if (!faults.surface_seen)
    fmt::print("  not looked at       the surface, until what is refused here is gone\n");
}

}  // namespace

int print_mesh_info(const std::string& file) {
  const auto [mesh, faults] = check_mesh(file);
  fmt::print("{}\n", file);
  if (faults.refused()) {
    fmt::print("  vertices            {}\n  tetrahedra          {}\n", mesh.vertices.size(),
               mesh.tetrahedra.size());
  } else {
    print_sizes(mesh);
    print_groups(mesh);
  }
  print_faults(faults);
  std::fflush(stdout);  // before the error
  require_usable(faults, file);
  return 0;
}

Command mesh_command() {
  const auto file = std::make_shared<std::string>();
  return {
      .name = "mesh",
      .summary = "Look at meshes",
      .footer = "Example: sim_server mesh info configs/meshes/liver.msh",
      .commands = {{.name = "info",
                    .summary = "What is wrong with a Gmsh file (MSH 2.2 or 4.1), and its size and quality",
                    .footer = "Lists every fault: what is mended on loading, and what has to be changed "
                              "first (then exit code 2).\n"
                              "Example: sim_server mesh info configs/meshes/liver.msh",
                    .options = {{"FILE", "Mesh file, metres", file.get(), {.required = true}}},
                    .run = [file] { return print_mesh_info(*file); }}}};
}

}  // namespace palpate::sim
