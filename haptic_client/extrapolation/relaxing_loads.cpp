#include "haptic_client/extrapolation/relaxing_loads.h"

#include <algorithm>

namespace palpate::client {
namespace {

constexpr Time kBetweenNotes = std::chrono::milliseconds(1);  // of the loads
constexpr double kForgotten = 1e-6;                           // N

double size_of(std::span<const Vec3> forces) noexcept {
  double largest = 0;
  for (const Vec3& force : forces) largest = std::max(largest, force.cwiseAbs().maxCoeff());
  return largest;
}

/// A vertex that moves in no mode is held.
bool is_held(const SurfaceModel& model, int vertex) noexcept {
  std::array<Vec3, kMaxPublishedModes> shapes;
  shapes.fill(Vec3::Zero());
  return model.add_shapes(vertex, 1, shapes) && size_of(shapes) == 0;
}

}  // namespace

RelaxingLoads::RelaxingLoads() {
  vertices_.reserve(kMost);
  creeping_.reserve(kMost);
}

void RelaxingLoads::begin(Time t, std::span<const Relaxation> series) noexcept {
  terms_ = std::min(series.size(), series_.size());
  std::copy_n(series.begin(), terms_, series_.begin());
  time_ = noted_ = t;
  vertices_.clear();
  creeping_.clear();
  past_.forget();
}

void RelaxingLoads::advance(Time t) noexcept {
  if (t <= time_) return;
  const SeriesStep step = over(t - time_);
  time_ = t;
  for (Vertex& vertex : vertices_) {
    if (!vertex.held) step.creep(vertex.psi, vertex.load, vertex.load);
  }
  note_creeping();
}

void RelaxingLoads::apply_loads(const SurfaceModel& model, std::span<const VertexLoad> loads,
                                double fraction) noexcept {
  if (terms_ == 0) return;
  for (Vertex& vertex : vertices_) vertex.load.setZero();
  for (const VertexLoad& load : loads) {
    if (Vertex* const vertex = find_or_add(model, load.vertex)) vertex->load = fraction * load.force;
  }
  std::erase_if(vertices_,
                [](const Vertex& v) { return v.load.isZero(0) && !v.held && size_of(v.psi) < kForgotten; });
  if (time_ - noted_ < kBetweenNotes) return;
  noted_ = time_;
  Loads* const now = past_.add(time_);
  if (now == nullptr) return;
  now->count = 0;
  for (const Vertex& vertex : vertices_) {
    if (vertex.load.isZero(0)) continue;
    now->vertex[now->count] = vertex.number;
    now->force[now->count++] = vertex.load.cast<float>();
  }
}

void RelaxingLoads::take(const SurfaceModel& model, const protocol::RelaxedState& published,
                         Time t) noexcept {
  std::array<Vertex*, kMost> known{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < published.vertices; ++i) {
    if (published.vertex[i].number >= model.rest().size()) continue;
    Vertex* const vertex = find_or_add(model, published.vertex[i].number);
    if (vertex == nullptr) continue;
    for (std::size_t j = 0; j < terms_; ++j)
      vertex->psi[j] = Eigen::Map<const Eigen::Vector3f>(&published.vertex[i].psi[3 * j]).cast<double>();
  }
  // Only now, as a vertex that is added may take the place of another.
  for (std::size_t i = 0; i < published.vertices; ++i) {
    Vertex* const vertex = find(published.vertex[i].number);
    if (vertex != nullptr && std::find(known.begin(), known.begin() + count, vertex) == known.begin() + count)
      known[count++] = vertex;
  }
  replay(std::span(known).first(count), t);
  note_creeping();
}

/// Takes vertices that are as they were at `t` on to now.
void RelaxingLoads::replay(std::span<Vertex* const> vertices, Time t) noexcept {
  std::array<Vec3, kMost> before;
  const Loads* const first = past_.at(t);
  for (std::size_t i = 0; i < vertices.size(); ++i)
    before[i] = first != nullptr ? first->on(vertices[i]->number) : vertices[i]->load;
  const auto integrate = [&](Time to, const Loads* loads) {
    const SeriesStep step = over(to - t);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const Vec3 load = loads != nullptr ? loads->on(vertices[i]->number) : vertices[i]->load;
      step.creep(vertices[i]->psi, before[i], load);
      before[i] = load;
    }
    t = to;
  };
  past_.for_each_since(t, [&](Time to, const Loads& loads) { integrate(to, &loads); });
  if (time_ > t) integrate(time_, nullptr);
}

Vec3 RelaxingLoads::Loads::on(int number) const noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    if (vertex[i] == number) return force[i].cast<double>();
  }
  return Vec3::Zero();
}

RelaxingLoads::Vertex* RelaxingLoads::find(int number) noexcept {
  const auto found = std::ranges::find(vertices_, number, &Vertex::number);
  return found == vertices_.end() ? nullptr : &*found;
}

/// Returns the load of this vertex, in place of the one that was pressed least where there are too many; null
/// where all are pressed now.
RelaxingLoads::Vertex* RelaxingLoads::find_or_add(const SurfaceModel& model, int number) noexcept {
  if (Vertex* const known = find(number)) return known;
  Vertex fresh{.number = number, .held = is_held(model, number)};
  fresh.psi.fill(Vec3::Zero());
  if (vertices_.size() < kMost) {
    vertices_.push_back(fresh);
    return &vertices_.back();
  }
  Vertex* least = nullptr;
  for (Vertex& vertex : vertices_) {
    if (vertex.load.isZero(0) && (least == nullptr || size_of(vertex.psi) < size_of(least->psi)))
      least = &vertex;
  }
  if (least != nullptr) *least = fresh;
  return least;
}

void RelaxingLoads::note_creeping() noexcept {
  creeping_.clear();
  for (const Vertex& vertex : vertices_) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t j = 0; j < terms_; ++j) sum += series_[j].fraction * vertex.psi[j];
    if (!vertex.held && !sum.isZero(0)) creeping_.push_back({vertex.number, sum});
  }
}

Vec3 RelaxingLoads::creep(const SurfaceModel& model, int vertex) const noexcept {
  Vec3 sum = Vec3::Zero();
  for (const VertexLoad& load : creeping_) {
    if (const auto c = model.compliance(vertex, load.vertex)) sum += *c * load.force;
  }
  return sum;
}

}  // namespace palpate::client
