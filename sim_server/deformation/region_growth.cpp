#include "sim_server/deformation/region_growth.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
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

/// Of each tetrahedron, a vertex that what can be cut shares with what can be later, if it can be cut and its
/// centre is within `reach` (m) of one, or that one of its corners; else -1.
std::vector<int> near_end_of(const TetMesh& mesh, std::span<const Removable> removable, double reach) {
  std::vector<char> now(mesh.vertices.size(), 0), later(now);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    for (const int v : mesh.tetrahedra[t]) {
      now[static_cast<std::size_t>(v)] |= removable[t] == Removable::kNow;
      later[static_cast<std::size_t>(v)] |= removable[t] == Removable::kLater;
    }
  }
  std::vector<int> end;
  for (std::size_t v = 0; v < now.size(); ++v) {
    if (now[v] != 0 && later[v] != 0) end.push_back(static_cast<int>(v));
  }
  std::vector<int> near(mesh.tetrahedra.size(), -1);
  for (std::size_t t = 0; t < near.size() && !end.empty(); ++t) {
    if (removable[t] != Removable::kNow) continue;
    const auto& corners = mesh.tetrahedra[t];
    const Vec3 centre = centre_of(mesh, corners);
    double closest = reach * reach;
    for (const int v : end) {
      const bool corner = std::ranges::find(corners, v) != corners.end();
      const double away = corner ? 0 : (mesh.vertices[static_cast<std::size_t>(v)] - centre).squaredNorm();
      if (away > closest) continue;
      closest = away;
      near[t] = v;
    }
  }
  return near;
}

constexpr int kMostDoublings = 6;  // of the time until what could not be made is tried again

}  // namespace

RegionGrowth::RegionGrowth(const ModelInputs& inputs, RegionInMotion region, double highest)
    : inputs_{inputs.scene, inputs.mesh, inputs.surface, inputs.fixed, inputs.reachable},
      region_(std::move(region)),
      highest_(highest),
      steps_(std::max(1L, std::lround(inputs.scene.cutting->growth->after / step_period(inputs.scene)))) {
  const double near = inputs_.scene.cutting->growth->reach / 2;
  near_end_ = near_end_of(inputs_.mesh, region_.removable, near);
  if (std::ranges::none_of(near_end_, [](int v) { return v >= 0; }))
    fail(
        "{}: what can be cut touches nothing that could be cut later; make the region here larger than that "
        "of "
        "[cutting], or remove this",
        inputs_.scene.cutting->growth->where);
}

void RegionGrowth::note_removed(std::span<const int> tetrahedra) {
  if (work_.valid()) {
    since_.removed.insert(since_.removed.end(), tetrahedra.begin(), tetrahedra.end());
    return;
  }
  note_seeds(tetrahedra);
}

void RegionGrowth::note_parted(std::span<const DeformationModel::Slide> slides, const Parting& parting) {
  if (!work_.valid()) return note_seeds(parting.tetrahedra);
  for (const DeformationModel::Slide& slide : slides) since_.slid.push_back(slide.vertex);
  Parting& all = since_.parting;
  const auto add = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  add(all.tetrahedra, parting.tetrahedra);
  add(all.splits, parting.splits);
  for (const auto& change : parting.changed) {
    const auto same = [&](const auto& other) { return other.first == change.first; };
    if (std::ranges::none_of(all.changed, same)) all.changed.push_back(change);
  }
}

/// A cut has come to these.
void RegionGrowth::note_seeds(std::span<const int> tetrahedra) {
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

/// Nothing is changed where this throws.
void RegionGrowth::begin(std::vector<int> allowed, const CuttableBody& now, const CutMesh& left) {
  RegionInMotion larger = region_;
  for (const int t : allowed) larger.removable[static_cast<std::size_t>(t)] = Removable::kNow;
  Begun begun{.mesh = inputs_.mesh,
              .left = left,
              .places = now.tensors.places(),
              .mass_factors = now.tensors.mass_factors(),
              .region = std::move(larger),
              .allowed = std::move(allowed)};
  work_ = std::async(std::launch::async, [this, &now, begun = std::move(begun)]() mutable {
    make_background("palpate-growth");
    return make(std::move(begun), now);
  });
  due_ = step_ + steps_;
  since_ = {};
}

/// In the background, while steps go on with the body of `now`.
RegionGrowth::Made RegionGrowth::make(Begun begun, const CuttableBody& now) const {
  const TetMesh& mesh = begun.mesh;
  const CutMesh left = begun.left.of_copy(mesh);
  const std::vector<int> fixed = fixed_by_now(inputs_.fixed, begun.places);
  const Progress silent = [](std::string_view, double) {};
  const ModelInputs inputs{inputs_.scene, mesh, inputs_.surface, fixed, inputs_.reachable, silent};
  const CondensedRest::Modes modes{
      .most = begun.region.rest_modes, .highest = highest_, .keeps_shapes = true};
  const std::vector<char> moves = begun.region.vertices(mesh, Removable::kNow);
  Made made;
  made.grown.body = std::make_unique<CuttableBody>(inputs, begun.mass_factors, &moves, modes);
  made.grown.body->remove(gone_of(left), left, *inputs_.scene.material);
  made.grown.hand_over = std::make_unique<HandOver>(*made.grown.body, now, begun.places);
  made.grown.allowed = std::move(begun.allowed);
  made.near_end = near_end_of(mesh, begun.region.removable, inputs_.scene.cutting->growth->reach / 2);
  made.region = std::move(begun.region);
  return made;
}

/// What can be cut stays as it is, and for a while nothing is begun.
void RegionGrowth::put_off(const std::exception& error, Step& step) {
  step.failure = error.what();
  not_before_ = step_ + (steps_ << std::min(failures_++, kMostDoublings));
}

/// What was removed meanwhile may be near the end of now, too.
RegionGrowth::Step RegionGrowth::end() {
  const Cuts since = std::exchange(since_, {});
  Step step;
  try {
    Made made = work_.get();
    made.grown.since = since;
    step.grown = std::move(made.grown);
    region_ = std::move(made.region);
    near_end_ = std::move(made.near_end);
    seeds_.clear();
    failures_ = 0;
  } catch (const std::exception& error) {
    put_off(error, step);
  }
  note_seeds(since.removed);
  note_seeds(since.parting.tetrahedra);
  return step;
}

RegionGrowth::Step RegionGrowth::step(const CuttableBody& now, const CutMesh& left, bool waits) {
  ++step_;
  if (work_.valid()) {
    if (step_ < due_) return {};
    const bool made = waits || work_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    return made ? end() : Step{.late = true};
  }
  if (seeds_.empty() || step_ < not_before_) return {};
  std::vector<int> allowed = near_seeds(left);
  if (allowed.empty()) {
    seeds_.clear();
    return {};
  }
  Step step;
  try {
    begin(std::move(allowed), now, left);
    step.begun = true;
  } catch (const std::exception& error) {
    put_off(error, step);
  }
  return step;
}

std::size_t RegionGrowth::bytes() const {
  return (inputs_.fixed.size() + inputs_.reachable.size() + near_end_.size()) * sizeof(int) +
         region_.removable.size();
}

}  // namespace palpate::sim
