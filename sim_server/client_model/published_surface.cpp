#include "sim_server/client_model/published_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "sim_server/mesh/loose_parts.h"
#include "sim_server/statics/linear_statics.h"

namespace palpate::sim {
namespace {

constexpr double kCalm = 0.1;  // s without a cut before it is worth beginning
// Time that the background may take, s: some 1.5 times what one core of a Zen 3 needs.
constexpr double kLeast = 0.1, kBodyOfTetrahedron = 5e-5, kSurfaceOfTetrahedron = 1.1e-5;
// Of the radius of a ball around a tool: so far from its middle the next one is begun; and so far from it a
// tool may be expected before another shape is published.
constexpr double kAmple = 0.2, kStays = 0.6;
// Of the time from begin to use: a tool that goes on is in the middle of the next ball half of it later.
constexpr double kLead = 1.5;
constexpr int kMostPutOffs = 6;  // doublings of the time until what could not be made is tried again

/// `standing`, and all that no tetrahedron has.
std::vector<int> fixed_of(const TetMesh& mesh, std::span<const int> standing) {
  std::vector<char> moves(mesh.vertices.size(), 0);
  for (const Tetrahedron& t : mesh.tetrahedra) {
    for (const int v : t) moves[static_cast<std::size_t>(v)] = 1;
  }
  for (const int v : standing) moves[static_cast<std::size_t>(v)] = 0;
  std::vector<int> fixed;
  for (std::size_t v = 0; v < moves.size(); ++v) {
    if (moves[v] == 0) fixed.push_back(static_cast<int>(v));
  }
  return fixed;
}

/// Adds the `most` on the surface that are nearest to `place`, of those that `known` is true of.
template <class Known>
void add_nearest(const Vec3& place, const SurfacePublisher::Tissue& tissue, const Known& known,
                 std::size_t most, PublishedSurface::Part& part) {
  std::vector<std::pair<double, int>> near;  // m^2
  for (int v = 0; v < static_cast<int>(tissue.positions.size()); ++v) {
    if (tissue.remaining.on_surface(v) && known(v))
      near.emplace_back((tissue.positions[static_cast<std::size_t>(v)] - place).squaredNorm(), v);
  }
  PublishedSurface::Ball ball{place, std::numeric_limits<double>::infinity()};
  if (near.size() > most) {
    const auto end = near.begin() + static_cast<std::ptrdiff_t>(most);
    std::ranges::nth_element(near, end);
    ball.radius = std::sqrt(end->first);
    near.erase(end, near.end());
  }
  for (const auto& [away, vertex] : near) part.vertices.push_back(vertex);
  std::ranges::sort(part.vertices);
  part.vertices.erase(std::unique(part.vertices.begin(), part.vertices.end()), part.vertices.end());
  part.balls.push_back(ball);
}

}  // namespace

int published_bodies(const Scene& scene) {
  const auto* const modes = scene.deformation.find<ClientModes>();
  return modes != nullptr && modes->modes > 0 ? 2 : 0;
}

bool PublishedSurface::Part::holds(const Vec3& place, double fraction) const noexcept {
  return std::ranges::any_of(balls, [&](const Ball& ball) { return ball.holds(place, fraction); });
}

/// The remaining body by itself: both the modes and the compliance of any part of its surface follow from it.
struct SurfacePublisher::Body {
  Body(const SurfacePublisher& owner, TetMesh&& remaining, const ElasticTensors& tensors,
       const Progress& progress, const SetupCache* cache)
      : mesh(std::move(remaining)),
        places(tensors.places()),
        masses(tensors.masses()),
        owner_(owner),
        progress_(progress) {
    inputs.cache = cache;
  }
  Body(const Body&) = delete;
  Body& operator=(const Body&) = delete;

  /// All else. `before`: a body of which some was cut since, whose modes these are like; null: none.
  void make(const Body* before) {
    standing = fixed_now(owner_.fixed_, places);
    drop_loose_parts(mesh, standing);  // a tool just pushes them away
    fixed = fixed_of(mesh, standing);
    statics.emplace(inputs);
    std::optional<VibrationModes> refined;
    if (before != nullptr && before->modes.shapes.cols() < statics->dofs.count)
      refined = refined_modes(statics->factor(), masses_in_motion(), shapes_of(*before));
    modes = refined ? std::move(*refined) : published_modes(inputs, *statics, masses_in_motion());
    (void)statics->factor();
    inputs.cache = nullptr;
    progress_ = [](std::string_view, double) {};
  }
  ModelInputs inputs_for(const std::vector<int>& vertices) const {
    return {owner_.scene_, mesh, owner_.surface_, fixed, vertices, progress_};
  }
  /// True if this surface vertex is known here: it was held, or is of a part that hangs on what was.
  bool has(int vertex) const {
    const int node = owner_.surface_.vertices[static_cast<std::size_t>(vertex)];
    return moves(vertex) || std::ranges::binary_search(standing, node);
  }
  bool moves(int vertex) const {
    return statics->dofs.first[owner_.surface_.vertices[static_cast<std::size_t>(vertex)]] >= 0;
  }
  std::size_t bytes() const {
    return (standing.size() + fixed.size() + places.size()) * sizeof(int) + masses.size() * sizeof(double) +
           static_cast<std::size_t>(modes.shapes.size()) * sizeof(double) + statics->factor().bytes();
  }

  TetMesh mesh;
  std::vector<int> standing, fixed;  // by themselves; besides, what no tetrahedron has
  std::vector<int> places;
  std::vector<double> masses;
  std::optional<LinearStatics> statics;
  VibrationModes modes;

 private:
  /// Those that what is in motion moves with, a little more than it has (`MassScaling`); of the rest those
  /// that it has. kg by unknowns.
  Eigen::VectorXd masses_in_motion() const {
    Eigen::VectorXd of_unknowns = statics->masses();
    for (std::size_t node = 0; node < places.size(); ++node) {
      const int first = statics->dofs.first[node];
      if (first >= 0 && places[node] >= 0)
        of_unknowns.segment<3>(first).setConstant(masses[static_cast<std::size_t>(places[node])]);
    }
    return of_unknowns;
  }
  /// The modes of `before` over these unknowns; vertices that it did not have stand.
  Eigen::MatrixXd shapes_of(const Body& before) const {
    Eigen::MatrixXd shapes = Eigen::MatrixXd::Zero(statics->dofs.count, before.modes.shapes.cols());
    for (std::size_t node = 0; node < places.size(); ++node) {
      const int from = before.statics->dofs.first[node], to = statics->dofs.first[node];
      if (from >= 0 && to >= 0) shapes.middleRows<3>(to) = before.modes.shapes.middleRows<3>(from);
    }
    return shapes;
  }

  const SurfacePublisher& owner_;
  Progress progress_;
  std::vector<int> none_;
  ModelInputs inputs = inputs_for(none_);
};

SurfacePublisher::SurfacePublisher(const ModelInputs& inputs, const ElasticTensors& tensors)
    : scene_(inputs.scene),
      surface_{inputs.surface.vertices, {}},
      fixed_(inputs.fixed),
      period_(step_period(inputs.scene)) {
  scene_.deformation.of<ComplianceTolerance>() = {};  // so few are dense
  const auto steps = [this](double seconds) { return static_cast<int>(std::ceil(seconds / period_)); };
  const auto tetrahedra = static_cast<double>(inputs.mesh.tetrahedra.size());
  calm_steps_ = steps(kCalm);
  body_steps_ = steps(kLeast + kBodyOfTetrahedron * tetrahedra);
  surface_steps_ = steps(kLeast + kSurfaceOfTetrahedron * tetrahedra);
  now_.last_cut = -calm_steps_;
  auto entire = std::make_shared<Body>(*this, TetMesh(inputs.mesh), tensors, inputs.progress, inputs.cache);
  entire->make(nullptr);
  now_.body = std::move(entire);
}

void SurfacePublisher::forget() noexcept {
  now_.surface.reset();
  if (now_.body) now_.before = std::move(now_.body);
  now_.in_vain = true;
  now_.last_cut = now_.step;
}

bool SurfacePublisher::is_due(bool waits) const {
  if (!now_.work.has_started()) return false;
  return waits ? now_.step >= now_.due : now_.work.is_ready();
}

void SurfacePublisher::step(std::span<const Tool> tools, const Tissue& tissue, bool waits) {
  ++now_.step;
  if (is_due(waits)) end();
  if (now_.work.has_started() || tools.empty() || now_.step < now_.not_before) return;
  try {
    start_next(tools, tissue);
  } catch (const std::exception& error) {
    put_off(error);
  }
}

/// Starts what is missing for these tools, if anything is.
void SurfacePublisher::start_next(std::span<const Tool> tools, const Tissue& tissue) {
  if (now_.body == nullptr) {
    if (now_.step - now_.last_cut > calm_steps_) start_body(tissue);
    return;
  }
  const auto ample = [this](const Tool& tool) {
    return now_.surface && now_.surface->compliant.holds(tool.p_W, kAmple);
  };
  if (!std::ranges::all_of(tools, ample)) start_surface(tools, tissue);
}

/// `make` gives what is `Made` in the background; in use from so many steps on.
template <class Make>
void SurfacePublisher::begin(int steps, Make make) {
  now_.in_vain = false;
  now_.due = now_.step + steps;
  now_.work.start("palpate-publish", std::move(make));
}

SurfacePublisher::State SurfacePublisher::save() const {
  State state = now_;
  if (state.surface) {
    state.amplitudes = state.surface->motion.amplitudes();
    state.rates = state.surface->motion.rates();
  }
  return state;
}

void SurfacePublisher::restore(const State& state) {
  now_ = state;
  if (now_.surface) now_.surface->motion.set(state.amplitudes, state.rates);
}

void SurfacePublisher::start_body(const Tissue& tissue) {
  TetMesh remaining = tissue.remaining.mesh();
  keep_tetrahedra(remaining, [&](std::size_t t) { return tissue.remaining.remains(static_cast<int>(t)); });
  auto body = std::make_shared<Body>(
      *this, std::move(remaining), tissue.tensors, [](std::string_view, double) {}, nullptr);
  begin(body_steps_, [body, before = now_.before] {
    body->make(before.get());
    return Made{body, nullptr};
  });
}

/// Predicts where the tool will be halfway through the use of the surface that is started now, within the one
/// that is published now.
Vec3 SurfacePublisher::expected_place(const Tool& tool) const {
  if (!now_.surface) return tool.p_W;
  const Vec3 path = kLead * surface_steps_ * period_ * tool.v_W;
  const double most = now_.surface->shape.balls.front().radius;
  return path.norm() <= most ? Vec3(tool.p_W + path) : Vec3(tool.p_W + most * path.normalized());
}

void SurfacePublisher::start_surface(std::span<const Tool> tools, const Tissue& tissue) {
  PublishedSurface::Part shape, compliant;
  const bool stays = now_.surface && std::ranges::all_of(tools, [this](const Tool& tool) {
                       return now_.surface->shape.holds(expected_place(tool), kStays);
                     });
  if (stays) shape = now_.surface->shape;
  const auto known = [this](int vertex) { return now_.body->has(vertex); };
  for (const Tool& tool : tools) {
    const Vec3 place = expected_place(tool);
    if (!stays) add_nearest(place, tissue, known, kShape, shape);
    add_nearest(place, tissue, known, kCompliant, compliant);
  }
  if (std::ranges::none_of(compliant.vertices, [&](int v) { return now_.body->moves(v); })) return;
  const std::uint32_t model = stays ? now_.surface->model : ++now_.models;
  begin(surface_steps_,
        [body = now_.body, shape = std::move(shape), compliant = std::move(compliant), model] {
          std::shared_ptr<PublishedSurface> surface(
              new PublishedSurface{PublishedMotion(body->inputs_for(compliant.vertices), *body->statics,
                                                   body->modes, body->places, body->masses),
                                   shape, compliant, model});
          return Made{body, std::move(surface)};
        });
}

void SurfacePublisher::end() {
  try {
    const Made made = *now_.work.take();
    now_.failures = 0;
    if (now_.in_vain) return;
    now_.body = made.body;
    now_.before.reset();
    if (made.surface) now_.surface = made.surface;
  } catch (const std::exception& error) {
    put_off(error);
  }
}

/// Postpones the next attempt, twice as long after each failure.
void SurfacePublisher::put_off(const std::exception& failure) {
  now_.failure = failure.what();
  now_.not_before = now_.step + (static_cast<long>(body_steps_) << std::min(now_.failures++, kMostPutOffs));
}

std::size_t SurfacePublisher::bytes() const noexcept {
  const std::size_t mine = (surface_.vertices.size() + fixed_.size()) * sizeof(int);
  const std::size_t bodies = (now_.body ? now_.body->bytes() : 0) + (now_.before ? now_.before->bytes() : 0);
  return mine + bodies +
         (now_.surface ? now_.surface->motion.bytes() + now_.surface->shape.vertices.size() * sizeof(int)
                       : 0);
}

}  // namespace palpate::sim
