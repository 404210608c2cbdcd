#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <numbers>

#include "common/log.h"
#include "common/program.h"
#include "sim_server/explain.h"
#include "sim_server/mesh/gmsh_io.h"
#include "sim_server/server.h"

namespace {

using namespace palpate;

int print_mesh_info(const std::string& file) {
  const sim::MeshInfo info = sim::describe(sim::read_mesh(file));
  constexpr double kDegrees = 180 / std::numbers::pi;
  const Vec3 size = info.max - info.min;
  fmt::print("{}\n", file);
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
      kDegrees * info.min_dihedral, kDegrees * info.max_dihedral, kDegrees * info.median_min_dihedral);
  if (size.maxCoeff() > 2) log::warning("the mesh is {:.3g} m long; is it in millimetres?", size.maxCoeff());
  return 0;
}

int run(int argc, char** argv) {
  CLI::App app{"Deforms an organ and answers a haptic client with forces, over UDP."};
  app.require_subcommand(1);
  app.footer("Example: sim_server run configs/scenes/liver.toml");

  sim::ServerOptions options;
  auto* run_command = app.add_subcommand("run", "Serve a scene until Ctrl-C");
  run_command->add_option("SCENE", options.scene, "Scene file (TOML)")->required();
  run_command
      ->add_option("--listen", options.listen,
                   "ADDR:PORT to listen on (UDP); 0.0.0.0:45130 for other machines")
      ->capture_default_str();
  run_command->add_option("--seconds", options.seconds, "Stop after so many seconds");
  run_command->add_option("--report", options.report, "Write figures of the run to this JSON file");
  run_command->footer(
      "Example: sim_server run configs/scenes/liver.toml --listen 0.0.0.0:45130 --report server.json");

  sim::ExplainOptions explain_options;
  auto* explain =
      app.add_subcommand("explain", "What a scene builds, what it leaves out, and what that saves");
  explain->add_option("SCENE", explain_options.scene, "Scene file (TOML)")->required();
  explain->add_option("--json", explain_options.json, "Write the same to this JSON file");
  explain->footer("Example: sim_server explain configs/scenes/liver.toml --json explain.json");

  std::string mesh_file;
  auto* mesh = app.add_subcommand("mesh", "Look at meshes");
  mesh->require_subcommand(1);
  auto* info =
      mesh->add_subcommand("info", "Counts, volume, size and quality of a Gmsh file (MSH 2.2 or 4.1)");
  info->add_option("FILE", mesh_file, "Mesh file, metres")->required();
  info->footer("Example: sim_server mesh info configs/meshes/liver.msh");

  if (const auto ended = parse_arguments(app, argc, argv)) return *ended;
  if (options.seconds) require_at_least(*options.seconds, 1e-3, "--seconds", "s");
  if (*explain) return sim::run_explain(explain_options);
  return *info ? print_mesh_info(mesh_file) : sim::run_server(options);
}

}  // namespace

int main(int argc, char** argv) {
  return palpate::run_program("sim_server", argc, argv, &run);
}
