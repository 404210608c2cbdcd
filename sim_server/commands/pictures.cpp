#include "sim_server/commands/pictures.h"

#include <algorithm>
#include <memory>

#include "common/parallel.h"
#include "sim_server/elasticity/solid.h"

namespace palpate::sim {
namespace {

OrganShape shape_of(const Scene& scene, const Simulation& simulation) {
  const Surface& surface = simulation.surface();
  OrganShape organ{simulation.rest(), surface.triangles, std::vector<std::uint8_t>(surface.vertices.size())};
  const std::vector<int> fixed = fixed_vertices(scene, simulation.mesh());
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    if (std::ranges::binary_search(fixed, surface.vertices[v])) organ.flags[v] |= OrganShape::kFixed;
  }
  for (std::size_t i = 0; i < simulation.tools(); ++i) {
    for (const Triangle& triangle : simulation.touchable(i)) {
      for (const int v : triangle) organ.flags[static_cast<std::size_t>(v)] |= OrganShape::kInReach;
    }
  }
  return organ;
}

void show_loads(std::span<const VertexLoad> loads, SeenTool& seen) noexcept {
  seen.load_count = std::min(loads.size(), SeenTool::kMostLoads);
  std::copy_n(loads.begin(), seen.load_count, seen.loads.begin());
}

/// A body of its own beside the one that is stepped, which another thread uses.
class StrainEnergy {
 public:
  StrainEnergy(const TetMesh& mesh, const Material& material, std::vector<int> surface)
      : solid_(mesh, material), scratch_(solid_), states_(solid_.points()), surface_(std::move(surface)) {}

  void of(std::span<const Vec3> nodes, std::vector<float>& values) {
    in_one_thread([&] { solid_.evaluate(nodes, states_, {}, scratch_); });
    energy_.assign(nodes.size(), 0);
    volume_.assign(nodes.size(), 0);
    const auto points = static_cast<std::size_t>(solid_.points_per_element());
    for (std::size_t e = 0; e < solid_.elements(); ++e) {
      double energy = 0, volume = 0;
      for (std::size_t p = e * points; p < (e + 1) * points; ++p) {
        volume += solid_.volume_of(p);
        energy += solid_.volume_of(p) * solid_.stiffness_of(p) * states_[p].energy;
      }
      for (const int node : solid_.element(e)) {
        energy_[static_cast<std::size_t>(node)] += energy;
        volume_[static_cast<std::size_t>(node)] += volume;
      }
    }
    values.resize(surface_.size());
    for (std::size_t v = 0; v < surface_.size(); ++v) {
      const auto node = static_cast<std::size_t>(surface_[v]);
      values[v] = static_cast<float>(std::max(0.0, energy_[node] / volume_[node]));
    }
  }

 private:
  Solid solid_;
  Solid::Scratch scratch_;
  std::vector<Solid::State> states_;
  std::vector<int> surface_;
  std::vector<double> energy_, volume_;  // of each node: J and m^3 of the tetrahedra around it
};

}  // namespace

std::function<void(std::span<const Vec3>, std::vector<float>&)> strain_energy_of(
    const Scene& scene, const Simulation& simulation) {
  auto made = std::make_shared<std::unique_ptr<StrainEnergy>>();
  return [&scene, &simulation, made](std::span<const Vec3> nodes, std::vector<float>& values) {
    if (!*made)
      *made =
          std::make_unique<StrainEnergy>(simulation.mesh(), *scene.material, simulation.surface().vertices);
    (*made)->of(nodes, values);
  };
}

SceneFacts facts_of(const Scene& scene, const Simulation& simulation) {
  SceneFacts facts{.title = scene.title,
                   .file = scene.source,
                   .model = scene.deformation.model,
                   .rate_hz = scene.rate_hz,
                   .tools = {},
                   .organ = shape_of(scene, simulation)};
  // Of an organ that is cut, the body that is coloured would have to be cut, too.
  if (!simulation.nodes().empty() && scene.material && !scene.cutting) facts.fields = {"strain_energy"};
  for (const ToolSettings& tool : scene.tools) {
    facts.tools.push_back(tool.shape);
    facts.blades = facts.blades || tool.blade;
  }
  return facts;
}

void show_tool(const SessionInput& input, const ServedTools::Outcome* outcome, double t,
               SeenTool& seen) noexcept {
  const bool lost = (input.state.flags & protocol::ToolState::kDeviceLost) != 0;
  seen.held = input.session != 0 && !lost;
  if (!seen.held)
    seen = {.pose = seen.pose, .sample = seen.sample};  // the force of the last holder is not shown
  if (seen.held) seen.pose = pose_of(input.state);
  if (outcome == nullptr || !seen.held) return;
  const ToolForce& force = outcome->force;
  seen.contact = force.contacts > 0;
  seen.flagged = force.flagged;
  seen.flagged_samples = outcome->flagged_samples;
  seen.f_W = force.force;
  if (outcome->answer)
    seen.sample = {outcome->answer->number, t, static_cast<float>(force.force.norm()),
                   outcome->answer->flags};
  if (outcome->answer && (outcome->answer->flags & protocol::ForceSample::kHasErrors) != 0)
    seen.errors = outcome->answer->errors;
}

namespace {

/// Without memory for the triangles the picture keeps those it has.
void show_cuts(const Simulation& simulation, Picture& picture) noexcept try {
  picture.triangles = simulation.surface().triangles;
  picture.cuts = simulation.resection()->version();
} catch (const std::bad_alloc&) {
}

SeenResection seen_of(const Resection& resection) noexcept {
  const ResectionTotals& all = resection.totals();
  SeenResection seen{.tetrahedra = all.tetrahedra,
                     .volume = all.volume,
                     .cut_area = all.cut_area,
                     .loose_pieces = all.loose_pieces};
  if (resection.has_plan() && all.tetrahedra > 0) {
    seen.mean_distance = all.mean_distance();
    seen.furthest = all.furthest;
  }
  if (resection.has_plan() && all.separated_area > 0)
    seen.mean_separated_distance = all.mean_separated_distance();
  return seen;
}

}  // namespace

void show_organ(const Simulation& simulation, Picture& picture) noexcept {
  std::size_t k = 0;
  for (const Vec3& p : simulation.positions()) {
    for (int i = 0; i < 3; ++i) picture.positions[k++] = static_cast<float>(p[i]);
  }
  const Resection* const resection = simulation.resection();
  if (resection != nullptr && resection->version() != picture.cuts) show_cuts(simulation, picture);
  if (resection != nullptr) picture.resection = seen_of(*resection);
  if (simulation.strain() != nullptr) picture.strain = *simulation.strain();
  for (std::size_t i = 0; i < simulation.tools(); ++i) show_loads(simulation.loads(i), picture.tools[i]);
}

}  // namespace palpate::sim
