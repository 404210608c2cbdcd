#include "sim_server/deformation/region_growth.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/error.h"
#include "common/realtime.h"

namespace palpate::sim {
namespace {

std::vector<int> gone_of(const CutMesh& left) {
  std::vector<int> gone;
  for (int t = 0; t < static_cast<int>(left.mesh().tetrahedra.size()); ++t) {
    if (!left.is_left(t)) gone.push_back(t);
  }
  return gone;
}

}  // namespace

RegionGrowth::RegionGrowth(const ModelInputs& inputs, RegionInMotion region, std::vector<double> mass_factors,
                           double highest)
    : inputs_{inputs.scene, inputs.mesh, inputs.surface, inputs.fixed, inputs.reachable},
      region_(std::move(region)),
      mass_factors_(std::move(mass_factors)),
      highest_(highest),
      steps_(std::max(1L, std::lround(inputs.scene.cutting->growth->after / step_period(inputs.scene)))) {
  find_end();
}

/// Of what can be cut, what is within half of the reach of a vertex that it shares with what can be later.
void RegionGrowth::find_end() {
  const TetMesh& mesh = inputs_.mesh;
  std::vector<char> now(mesh.vertices.size(), 0), later(now);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    for (const int v : mesh.tetrahedra[t]) {
      now[static_cast<std::size_t>(v)] |= region_.removable[t] == Removable::kNow;
      later[static_cast<std::size_t>(v)] |= region_.removable[t] == Removable::kLater;
    }
  }
  std::vector<int> end;
  for (std::size_t v = 0; v < now.size(); ++v) {
    if (now[v] != 0 && later[v] != 0) end.push_back(static_cast<int>(v));
  }
  near_end_.assign(mesh.tetrahedra.size(), -1);
  for (std::size_t t = 0; t < mesh.tetrahedra.size() && !end.empty(); ++t) {
    if (region_.removable[t] != Removable::kNow) continue;
    const Vec3 centre = centre_of(mesh, mesh.tetrahedra[t]);
    const auto away = [&](int v) {
      const auto& corners = mesh.tetrahedra[t];
      if (std::ranges::find(corners, v) != corners.end()) return 0.0;
      return (mesh.vertices[static_cast<std::size_t>(v)] - centre).squaredNorm();
    };
    const int nearest = *std::ranges::min_element(end, {}, away);
    if (std::sqrt(away(nearest)) <= inputs_.scene.cutting->growth->reach / 2) near_end_[t] = nearest;
  }
}

void RegionGrowth::note_removed(std::span<const int> tetrahedra) {
  if (work_.valid()) {
    removed_since_.insert(removed_since_.end(), tetrahedra.begin(), tetrahedra.end());
    return;
  }
  for (const int t : tetrahedra) {
    const int seed = near_end_[static_cast<std::size_t>(t)];
    if (seed >= 0 && std::ranges::find(seeds_, seed) == seeds_.end()) seeds_.push_back(seed);
  }
}

/// What is left that can be removed later, and has its centre within the reach of a seed, or that as a
/// corner.
std::vector<int> RegionGrowth::near_seeds(const CutMesh& left) const {
  const double reach = inputs_.scene.cutting->growth->reach;
  std::vector<int> near;
  for (int t = 0; t < static_cast<int>(inputs_.mesh.tetrahedra.size()); ++t) {
    const auto tetrahedron = static_cast<std::size_t>(t);
    if (region_.removable[tetrahedron] != Removable::kLater || !left.is_left(t)) continue;
    const Vec3 centre = centre_of(inputs_.mesh, inputs_.mesh.tetrahedra[tetrahedron]);
    const auto& corners = inputs_.mesh.tetrahedra[tetrahedron];
    const auto is_near = [&](int seed) {
      return (inputs_.mesh.vertices[static_cast<std::size_t>(seed)] - centre).norm() <= reach ||
             std::ranges::find(corners, seed) != corners.end();
    };
    if (std::ranges::any_of(seeds_, is_near)) near.push_back(t);
  }
  return near;
}

void RegionGrowth::begin(const CuttableBody& now, const CutMesh& left) {
  for (const int t : allowed_) region_.removable[static_cast<std::size_t>(t)] = Removable::kNow;
  removed_since_.clear();
  due_ = step_ + steps_;
  work_ = std::async(std::launch::async, [this, &now, left,
                                          moves = region_.vertices(inputs_.mesh, Removable::kNow)] {
    make_background("palpate-growth");
    const Progress silent = [](std::string_view, double) {};
    const ModelInputs inputs{inputs_.scene, inputs_.mesh,      inputs_.surface,
                             inputs_.fixed, inputs_.reachable, silent};
    const CondensedRest::Modes modes{.most = region_.rest_modes, .highest = highest_, .keeps_shapes = true};
    Grown grown;
    grown.body = std::make_unique<CuttableBody>(inputs, mass_factors_, &moves, modes);
    grown.body->remove(gone_of(left), left, *inputs_.scene.material);
    grown.hand_over = std::make_unique<HandOver>(*grown.body, now);
    return grown;
  });
}

RegionGrowth::Step RegionGrowth::step(const CuttableBody& now, const CutMesh& left) {
  Step step;
  ++step_;
  if (work_.valid() && step_ >= due_) {
    try {
      step.grown = work_.get();
      step.grown->allowed = std::exchange(allowed_, {});
      step.grown->removed_since = std::exchange(removed_since_, {});
      find_end();
      note_removed(step.grown->removed_since);  // that may be near the end of now, too
    } catch (const std::exception& error) {
      step.failure = error.what();
      for (const int t : allowed_) region_.removable[static_cast<std::size_t>(t)] = Removable::kLater;
      allowed_.clear();
    }
  } else if (!work_.valid() && !seeds_.empty()) {
    allowed_ = near_seeds(left);
    step.begun = !allowed_.empty();
    if (step.begun) begin(now, left);
    seeds_.clear();
  }
  return step;
}

std::size_t RegionGrowth::bytes() const {
  return (inputs_.fixed.size() + inputs_.reachable.size() + near_end_.size()) * sizeof(int) +
         mass_factors_.size() * sizeof(double) + region_.removable.size();
}

}  // namespace palpate::sim
