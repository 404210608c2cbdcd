#include "sim_server/deformation/told_nearby.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "common/parallel.h"
#include "common/realtime.h"
#include "sim_server/deformation/cuttable_body.h"
#include "sim_server/deformation/linear_statics.h"
#include "sim_server/mesh/loose_parts.h"

namespace palpate::sim {
namespace {

constexpr double kCalm = 0.1;  // s without a cut before it is worth beginning
// s that the background may take: some 1.5 times what one core of the reference machine of `StepCosts`
// needs.
constexpr double kLeast = 0.1, kBodyOfTetrahedron = 5e-5, kSurfaceOfTetrahedron = 1.1e-5;
// Of the radius of a ball around a tool: so far from its middle the next one is begun; and so far from it a
// tool may be expected before another shape is told.
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
void add_nearest(const Vec3& place, const ToldNearby::Tissue& tissue, const Known& known, std::size_t most,
                 ToldSurface::Part& part) {
  std::vector<std::pair<double, int>> near;  // m^2
  for (int v = 0; v < static_cast<int>(tissue.positions.size()); ++v) {
    if (tissue.left.on_surface(v) && known(v))
      near.emplace_back((tissue.positions[static_cast<std::size_t>(v)] - place).squaredNorm(), v);
  }
  ToldSurface::Ball ball{place, std::numeric_limits<double>::infinity()};
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

int told_bodies(const Scene& scene) {
  const auto* const modes = scene.deformation.find<ClientModes>();
  return modes != nullptr && modes->modes > 0 ? 2 : 0;
}

bool ToldSurface::Part::holds(const Vec3& place, double share) const noexcept {
  return std::ranges::any_of(balls, [&](const Ball& ball) { return ball.holds(place, share); });
}

/// What is left, by itself: what both the modes and the compliance of any part of its surface follow from.
struct ToldNearby::Body {
  Body(const ToldNearby& owner, TetMesh&& left, const ElasticTensors& tensors, const Progress& tells,
       const SetupCache* cache)
      : mesh(std::move(left)),
        places(tensors.places()),
        masses(tensors.masses()),
        owner_(owner),
        progress_(tells) {
    inputs.cache = cache;
  }
  Body(const Body&) = delete;
  Body& operator=(const Body&) = delete;

  /// All else. `before`: a body of which some was cut since, whose modes these are like; null: none.
  void make(const Body* before) {
    standing = fixed_by_now(owner_.fixed_, places);
    drop_loose_parts(mesh, standing);  // a tool just pushes them away
    fixed = fixed_of(mesh, standing);
    statics.emplace(inputs);
    std::optional<VibrationModes> refined;
    if (before != nullptr && before->modes.shapes.cols() < statics->dofs.count)
      refined = refined_modes(statics->factor(), masses_in_motion(), shapes_of(*before));
    modes = refined ? std::move(*refined) : told_modes(inputs, *statics, masses_in_motion());
    (void)statics->factor();
    inputs.cache = nullptr;
    progress_ = [](std::string_view, double) {};
  }
  ModelInputs inputs_for(const std::vector<int>& vertices) const {
    return {owner_.scene_, mesh, owner_.surface_, fixed, vertices, progress_};
  }
  /// Whether this surface vertex is known here: it was held, or is of a part that hangs on what was.
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

  const ToldNearby& owner_;
  Progress progress_;
  std::vector<int> none_;
  ModelInputs inputs = inputs_for(none_);
};

ToldNearby::ToldNearby(const ModelInputs& inputs, const ElasticTensors& tensors)
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
  last_cut_ = -calm_steps_;
  auto whole = std::make_shared<Body>(*this, TetMesh(inputs.mesh), tensors, inputs.progress, inputs.cache);
  whole->make(nullptr);
  body_ = std::move(whole);
}

void ToldNearby::forget() noexcept {
  told_.reset();
  if (body_) before_ = std::move(body_);
  in_vain_ = true;
  last_cut_ = step_;
}

bool ToldNearby::is_due(bool waits) const {
  if (!work_.valid()) return false;
  return waits ? step_ >= due_ : work_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

void ToldNearby::step(std::span<const Tool> tools, const Tissue& tissue, bool waits) {
  ++step_;
  if (is_due(waits)) end();
  if (work_.valid() || tools.empty() || step_ < not_before_) return;
  try {
    begin_next(tools, tissue);
  } catch (const std::exception& error) {
    put_off(error);
  }
}

/// What is missing for these tools, if anything is.
void ToldNearby::begin_next(std::span<const Tool> tools, const Tissue& tissue) {
  if (body_ == nullptr) {
    if (step_ - last_cut_ > calm_steps_) begin_body(tissue);
    return;
  }
  const auto ample = [this](const Tool& tool) { return told_ && told_->compliant.holds(tool.p_W, kAmple); };
  if (!std::ranges::all_of(tools, ample)) begin_surface(tools, tissue);
}

/// `make` gives what is `Made` in the background; in use from so many steps on.
template <class Make>
void ToldNearby::begin(int steps, Make make) {
  in_vain_ = false;
  due_ = step_ + steps;
  work_ = std::async(std::launch::async, [make = std::move(make)] {
    make_background("palpate-told");
    Made made;
    in_one_thread([&] { made = make(); });
    return made;
  });
}

void ToldNearby::begin_body(const Tissue& tissue) {
  TetMesh left = tissue.left.mesh();
  keep_tetrahedra(left, [&](std::size_t t) { return tissue.left.is_left(static_cast<int>(t)); });
  auto body = std::make_shared<Body>(
      *this, std::move(left), tissue.tensors, [](std::string_view, double) {}, nullptr);
  begin(body_steps_, [body, before = before_] {
    body->make(before.get());
    return Made{body, nullptr};
  });
}

/// Where it will have gone halfway through the use of what is begun now, within what is told now.
Vec3 ToldNearby::expected_place(const Tool& tool) const {
  if (!told_) return tool.p_W;
  const Vec3 way = kLead * surface_steps_ * period_ * tool.v_W;
  const double most = told_->shape.balls.front().radius;
  return way.norm() <= most ? Vec3(tool.p_W + way) : Vec3(tool.p_W + most * way.normalized());
}

void ToldNearby::begin_surface(std::span<const Tool> tools, const Tissue& tissue) {
  ToldSurface::Part shape, compliant;
  const bool stays = told_ && std::ranges::all_of(tools, [this](const Tool& tool) {
                       return told_->shape.holds(expected_place(tool), kStays);
                     });
  if (stays) shape = told_->shape;
  const auto known = [this](int vertex) { return body_->has(vertex); };
  for (const Tool& tool : tools) {
    const Vec3 place = expected_place(tool);
    if (!stays) add_nearest(place, tissue, known, kShape, shape);
    add_nearest(place, tissue, known, kCompliant, compliant);
  }
  if (std::ranges::none_of(compliant.vertices, [&](int v) { return body_->moves(v); })) return;
  const std::uint32_t model = stays ? told_->model : ++models_;
  begin(surface_steps_, [body = body_, shape = std::move(shape), compliant = std::move(compliant), model] {
    std::shared_ptr<ToldSurface> surface(
        new ToldSurface{ToldMotion(body->inputs_for(compliant.vertices), *body->statics, body->modes,
                                   body->places, body->masses),
                        shape, compliant, model});
    return Made{body, std::move(surface)};
  });
}

void ToldNearby::end() {
  try {
    Made made = work_.get();
    failures_ = 0;
    if (in_vain_) return;
    body_ = std::move(made.body);
    before_.reset();
    if (made.surface) told_ = std::move(made.surface);
  } catch (const std::exception& error) {
    put_off(error);
  }
}

/// The next that begins.
void ToldNearby::put_off(const std::exception& failure) {
  failure_ = failure.what();
  not_before_ = step_ + (static_cast<long>(body_steps_) << std::min(failures_++, kMostPutOffs));
}

std::size_t ToldNearby::bytes() const noexcept {
  const std::size_t mine = (surface_.vertices.size() + fixed_.size()) * sizeof(int);
  const std::size_t bodies = (body_ ? body_->bytes() : 0) + (before_ ? before_->bytes() : 0);
  return mine + bodies + (told_ ? told_->motion.bytes() + told_->shape.vertices.size() * sizeof(int) : 0);
}

}  // namespace palpate::sim
