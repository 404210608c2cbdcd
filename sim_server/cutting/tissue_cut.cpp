#include "sim_server/cutting/tissue_cut.h"

#include <algorithm>
#include <utility>

#include "sim_server/client_model/published_surface.h"
#include "sim_server/scene/touchable.h"

namespace palpate::sim {
namespace {

constexpr double kRounding = 1e-9;   // s
constexpr double kAtRest = 6e-4;     // m/s: below this speed a blade is resisted less
constexpr double kWorkedOff = 1e-7;  // J: a debt that a released blade drops

bool goes_beyond_its_edge(const BladeEdge& was, const BladeEdge& is) {
  return std::max((is[0] - was[0]).norm(), (is[1] - was[1]).norm()) > (is[1] - is[0]).norm();
}

}  // namespace

TissueCut::TissueCut(const Scene& scene, TetMesh& mesh, std::span<const int> held, Surface& surface)
    : resection_(*scene.cutting, mesh, held, surface, scene.blade() != nullptr),
      tools_(scene.tools),
      toughness_(scene.cutting->toughness),
      blades_(scene.tools.size()),
      hot_at_(scene.tools.size()) {}

void TissueCut::set_options(CutOptions options) {
  options_ = std::move(options);
  done_ = 0;
}

bool TissueCut::is_hot(std::size_t tool, const ToolContact& contact, const ToolInput& input) const {
  return (input.buttons & tools_[tool].cut_buttons) != 0 && input.pose && contact.placed();
}

/// Heats along the path of the tips that were hot in the step before.
std::span<const int> TissueCut::remove_by_heat(std::span<const ToolInput> inputs, double dt,
                                               CutOrgan& organ) {
  tips_.clear();
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    const ToolContact& contact = organ.tools[i];
    const std::optional<Vec3> from = std::exchange(hot_at_[i], std::nullopt);
    if (from && contact.placed()) tips_.push_back({*from, contact.place(), contact.radius()});
    if (!tools_[i].blade && is_hot(i, contact, inputs[i])) hot_at_[i] = contact.place();
  }
  return resection_.advance(tips_, organ.tissue.positions, dt, organ.surface);
}

std::span<const int> TissueCut::remove_planned(double time, CutOrgan& organ) {
  const std::vector<Removal>& planned = *options_.planned;
  std::vector<int> due;
  for (; done_ < planned.size() && planned[done_].t <= time + kRounding; ++done_)
    due.push_back(planned[done_].tetrahedron);
  std::erase_if(due, [&](int tetrahedron) {
    const CutMesh& remaining = resection_.remaining();
    return !remaining.remains(tetrahedron) || !remaining.is_removable(tetrahedron);
  });
  std::ranges::sort(due);
  due.erase(std::unique(due.begin(), due.end()), due.end());
  return resection_.remove(due, organ.surface);
}

bool TissueCut::start_step(std::span<const ToolInput> inputs, double time, double dt, CutOrgan organ) {
  resection_.start_step();
  const std::span<const int> removed =
      options_.planned ? remove_planned(time, organ) : remove_by_heat(inputs, dt, organ);
  if (!removed.empty()) {
    for (const int tetrahedron : resection_.requested()) removed_.push_back({time, tetrahedron});
    count(organ.tissue.traits.cuttable->remove(removed, resection_.remaining()));
    organ.tissue.note_same_place();  // of vertices that this exposed, too
  }
  const bool parted = !options_.planned && part_by_blades(inputs, dt, organ);
  if ((parted || !removed.empty()) && resection_.totals().loose_pieces > 0) let_float(organ);
  if (resection_.version() != touchable_version_) change_surface(organ);
  return publish(inputs, organ);
}

/// Lets parts float that nothing holds any more.
void TissueCut::let_float(CutOrgan& organ) {
  const CutMesh& remaining = resection_.remaining();
  const std::vector<std::vector<int>> parts = resection_.floating();
  organ.tissue.traits.cuttable->release(parts, remaining);
  floating_.assign(parts.empty() ? 0 : organ.rest.size(), 0);
  for (const std::vector<int>& tetrahedra : parts) {
    for (const int t : tetrahedra) {
      for (const int v : organ.mesh.tetrahedra[static_cast<std::size_t>(t)]) {
        if (remaining.number_of(v) >= 0) floating_[static_cast<std::size_t>(remaining.number_of(v))] = 1;
      }
    }
  }
}

/// Updates the surface published to clients.
bool TissueCut::publish(std::span<const ToolInput> inputs, CutOrgan& organ) {
  if (organ.tissue.traits.client == nullptr) return false;
  asking_.clear();
  for (const ToolInput& input : inputs) {
    if (input.request.surface_shift && input.pose) asking_.push_back({input.pose->p_W, input.v_W});
  }
  std::shared_ptr<const PublishedSurface> published =
      organ.tissue.traits.client->publish(asking_, resection_.remaining(), options_.waits_for_background);
  if (published == published_) return false;
  published_ = std::move(published);
  return true;
}

void TissueCut::count(const CuttableModel::Removed& lost) {
  ResectionTotals& totals = resection_.totals();
  totals.elastic += lost.elastic;
  totals.kinetic += lost.kinetic;
  totals.momentum += lost.momentum;
}

/// Parts tissue along the path of the blades in the step before. Returns true if that changed any.
bool TissueCut::part_by_blades(std::span<const ToolInput> inputs, double dt, CutOrgan& organ) {
  bool parted = false;
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    std::optional<Blade>& blade = blades_[i];
    if (!tools_[i].blade) continue;
    const ToolContact& contact = organ.tools[i];
    const bool cuts = is_hot(i, contact, inputs[i]);
    if (!contact.placed() || (!cuts && blade && !blade->was && blade->debt < kWorkedOff)) blade.reset();
    if (!blade && !cuts) continue;
    if (!blade) blade.emplace();
    const ToolPose& pose = contact.pose();
    blade->is = {pose.p_W, pose.p_W + pose.q_W * *tools_[i].blade};
    if (blade->was) {
      parted |= part_by(i, dt, organ);
      if (!cuts) blade->was.reset();  // that was the path before it was released
    } else if (cuts) {
      blade->trail.setZero();
      blade->was = blade->is;
      blade->were.assign(organ.tissue.positions.begin(), organ.tissue.positions.end());
    }
  }
  return parted;
}

bool TissueCut::part_by(std::size_t tool, double dt, CutOrgan& organ) {
  Blade& blade = *blades_[tool];
  std::vector<Vec3> are(organ.tissue.positions.begin(), organ.tissue.positions.end());
  std::vector<int> touched;  // by others: a vertex in a grip does not slide
  for (std::size_t other = 0; other < tools_.size(); ++other) {
    if (other == tool) continue;
    for (const VertexLoad& load : organ.tissue.loads_of(other))
      touched.push_back(organ.surface.vertices[static_cast<std::size_t>(load.vertex)]);
  }
  resection_.keep(std::move(touched));
  const Separated& separated =
      resection_.part({*blade.was, blade.is, blade.trail}, blade.were, are, organ.surface);
  if (!separated.stroke.moved) return false;
  if (separated.stroke.at_end) resection_.totals().time_at_end += dt;
  blade.outran = blade.outran || (separated.area > 0 && goes_beyond_its_edge(*blade.was, blade.is));
  blade.was = blade.is;
  blade.trail = separated.stroke.trail;
  blade.were = std::move(are);
  blade.debt += toughness_ * separated.area;
  follow_rest(separated, tool, organ);
  if (separated.stroke.slides.empty() && separated.stroke.faces.empty()) return false;
  organ.tissue.traits.cuttable->part(separated.stroke.slides, separated.parting, resection_.remaining());
  organ.tissue.note_same_place();
  if (!resection_.removed().empty())
    count(organ.tissue.traits.cuttable->remove(resection_.removed(), resection_.remaining()));
  return true;
}

/// Moves the rest places of vertices that slid or became two, and, of the other blades, their places at the
/// last look.
void TissueCut::follow_rest(const Separated& separated, std::size_t tool, CutOrgan& organ) {
  const CutMesh& remaining = resection_.remaining();
  const auto number = [&](int vertex) { return static_cast<std::size_t>(remaining.number_of(vertex)); };
  const auto update_rest = [&](int vertex) {
    organ.rest[number(vertex)] = organ.mesh.vertices[static_cast<std::size_t>(vertex)];
  };
  for (const auto& [vertex, towards, fraction] : separated.stroke.slides) {
    update_rest(vertex);
    for (std::size_t i = 0; i < tools_.size(); ++i) {
      if (i == tool || !blades_[i] || !blades_[i]->was) continue;
      std::vector<Vec3>& were = blades_[i]->were;
      were[number(vertex)] += fraction * (were[number(towards)] - were[number(vertex)]);
    }
  }
  for (const Split& split : separated.parting.splits) {
    splits_.push_back({remaining.number_of(split.vertex), remaining.number_of(split.copy)});
    update_rest(split.copy);
    for (std::optional<Blade>& each : blades_) {
      if (each && each->was) each->were[number(split.copy)] = each->were[number(split.vertex)];
    }
  }
}

void TissueCut::resist(std::size_t tool, const ToolContact& contact, double dt, ToolAnswer& answer) {
  if (!blades_[tool]) return;
  Blade& blade = *blades_[tool];
  const Vec3& p = contact.place();
  const Vec3 motion = p - blade.place.value_or(p);
  blade.place = p;
  const double far = motion.norm();
  blade.force.setZero();
  if (far > 0) blade.force = -blade.debt / (resection_.blade_size() + far) / (far + kAtRest * dt) * motion;
  blade.debt += blade.force.dot(motion);
  if (blade.outran) {  // the hand is elsewhere by now: the work is owed to no path of it
    answer.flagged = true;
    ++resection_.totals().outrun_steps;
    blade.debt = 0;
    blade.outran = false;
  }
  answer.force += blade.force;
  answer.mean_force += blade.force;
  if (!contact.shape().trocar) answer.torque += 0.5 * (blade.is[1] - blade.is[0]).cross(blade.force);
}

/// Gives the tools the triangles of the surface as it is now.
void TissueCut::change_surface(CutOrgan& organ) {
  const CutMesh& remaining = resection_.remaining();
  const SurfaceChange change{organ.rest, organ.surface,
                             [&remaining](int v) { return remaining.on_surface(v); }, splits_};
  organ.tissue.change_surface(change);
  auto touchable = touchable_by(tools_, organ.surface, organ.mesh);
  for (std::size_t i = 0; i < tools_.size(); ++i)
    organ.tools[i].change_surface(change, std::move(touchable[i]));
  touchable_version_ = resection_.version();
  splits_.clear();
}

void TissueCut::end_step(std::span<const ToolInput> inputs, double time, double dt,
                         std::span<const ToolContact> tools, std::span<ToolAnswer> answers) {
  bool touched = false;
  for (std::size_t i = 0; i < tools.size(); ++i)
    touched =
        touched || (!tools_[i].blade && is_hot(i, tools[i], inputs[i]) && tools[i].force().contacts > 0);
  ResectionTotals& totals = resection_.totals();
  if (touched) totals.contact_time += dt;
  for (std::size_t i = 0; i < tools.size(); ++i) {
    answers[i].cutting = is_hot(i, tools[i], inputs[i]);
    if (!answers[i].cutting) continue;
    Vec3 force = tools[i].force().force;
    if (blades_[i]) force += blades_[i]->force;
    if (!options_.keeps_log) log_.clear();
    log_.push_back({time, i, tools[i].place(), force, tools[i].force().contacts > 0, totals});
  }
}

}  // namespace palpate::sim
