#include "sim_server/explicit/explicit_motion.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "common/error.h"
#include "common/parallel.h"
#include "sim_server/tissue/model_inputs.h"

namespace palpate::sim {
namespace {
constexpr int kMostProducts = 1000;    // of the power iteration, which ends sooner by `kSettled`
constexpr double kSettled = 1e-6;      // growth of the Rayleigh quotient
constexpr double kMostSubSteps = 2e4;  // no step of so many is in time

/// Returns how many threads share a product: at most as many as it has parts.
int threads_for(const ElasticTensors& tensors, int most) {
  return std::min(most > 0 ? most : static_cast<int>(threads()), static_cast<int>(tensors.parts()));
}
}  // namespace

double highest_frequency(const ElasticTensors& tensors) {
  const std::vector<double>& mass = tensors.masses();
  std::vector<double> x(3 * mass.size()), force(x.size());
  std::minstd_rand random;  // any start will do that is the same every time
  for (double& value : x) value = static_cast<double>(random()) / std::minstd_rand::max() - 0.5;
  double quotient = 0;
  for (int i = 0; i < kMostProducts; ++i) {
    tensors.multiply(x.data(), force.data());
    double work = 0, inertia = 0, size = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
      work += x[k] * force[k];
      inertia += x[k] * x[k] * mass[k / 3];
      x[k] = force[k] / mass[k / 3];
      size += x[k] * x[k];
    }
    for (double& value : x) value /= std::sqrt(size);
    const double before = quotient;
    quotient = work / inertia;
    if (quotient - before < kSettled * quotient) break;
  }
  return std::sqrt(quotient);
}

double longest_sub_step(double w, const RayleighDamping& damping) {
  const double d = damping.mass + damping.stiffness * w * w;
  return 4 / (d + std::sqrt(d * d + 4 * w * w));
}

double count_sub_steps(const Scene& scene, double longest) {
  const double steps = std::ceil(step_period(scene) / longest);
  if (steps > kMostSubSteps) {
    fail(
        "{}: a step at {:g} Hz would take {:g} sub-steps of {:.2g} s, and {:g} are the most; model \"{}\" is "
        "for soft tissue: take a model of implicit steps, a larger `rate_hz` or a smaller "
        "`rayleigh_stiffness`",
        scene.source, scene.rate_hz, steps, longest, kMostSubSteps, scene.deformation.model);
  }
  return steps;
}

ExplicitMotion::ExplicitMotion(const ElasticTensors& tensors, const RayleighDamping& damping, int columns,
                               int most_threads)
    : tensors_(tensors),
      damping_(damping),
      columns_(columns),
      team_(columns == 1 ? threads_for(tensors, most_threads) - 1 : 0) {
  if (columns == 1) ahead_ = tensors.room_ahead();
  if (columns == 1 && tensors.parts() > 1) kicks_.reserve(tensors.masses().size());
  for (auto* const all : {&state.u, &state.v, &state.f})
    all->assign(3 * tensors.masses().size() * columns, 0);
  for (auto* const all : {&bent_, &resistance_})
    all->assign(numbers_per_vertex() * tensors.masses().size(), 0);
}

void ExplicitMotion::append_copy_of(int place) {
  const auto append = [place](std::vector<double>& all, int numbers_per_vertex) {
    for (int i = 0; i < numbers_per_vertex; ++i)
      all.push_back(double{all[static_cast<std::size_t>(numbers_per_vertex * place + i)]});
  };
  for (auto* const all : {&state.u, &state.v, &state.f}) append(*all, 3);
  for (auto* const all : {&bent_, &resistance_}) append(*all, ElasticTensors::kNumbersPerVertex);
}

ExplicitMotion::Snapshot ExplicitMotion::save() {
  if (begun_) team_.finish();
  return {state, bent_, resistance_, ahead_, kicks_, begun_, floating_, frames_};
}

void ExplicitMotion::restore(const Snapshot& saved) {
  if (begun_) team_.finish();
  state = saved.state;
  bent_ = saved.bent;
  resistance_ = saved.resistance;
  ahead_ = saved.ahead;
  kicks_.assign(saved.kicks.begin(), saved.kicks.end());
  begun_ = saved.begun;
  floating_ = saved.floating;
  frames_ = saved.frames;
}

void ExplicitMotion::release(FloatingPieces pieces) {
  drop_next();
  floating_ = std::move(pieces);
  frames_.resize(floating_.count());
  find_frames();
}

void ExplicitMotion::find_frames() noexcept {
  drop_next();
  turn_bent();
}

Vec3 ExplicitMotion::turned_displacement(int place) const {
  const Vec3 u = Eigen::Map<const Vec3>(state.u.data() + std::ptrdiff_t{3} * place);
  const int p = floating_.piece_of(place);
  if (p < 0) return u;
  return FloatingPieces::turned_back(floating_.node(place), frames_[static_cast<std::size_t>(p)], u);
}

void ExplicitMotion::add_to_last(int place, double h, const Vec3& force) noexcept {
  Eigen::Map<Vec3>(state.f.data() + std::ptrdiff_t{3} * place) += force;
  add_impulse(place, h, h / tensors_.masses()[static_cast<std::size_t>(place)] * force);
}

void ExplicitMotion::add_impulse(int place, double h, const Vec3& dv) noexcept {
  const std::ptrdiff_t first = std::ptrdiff_t{3} * place,
                       numbers_per_vertex = std::ptrdiff_t{ElasticTensors::kNumbersPerVertex} * place;
  Eigen::Map<Vec3>(state.v.data() + first) += dv;
  Eigen::Map<Vec3>(state.u.data() + first) += h * dv;
  Vec3 path = (h + damping_.stiffness) * dv;
  const int piece = floating_.piece_of(place);
  if (piece >= 0) path = (frames_[static_cast<std::size_t>(piece)].R.transpose() * path).eval();
  if (begun_ && kicks_.size() == kicks_.capacity()) drop_next();
  if (begun_)
    kicks_.push_back({place, path});
  else
    Eigen::Map<Vec3>(bent_.data() + numbers_per_vertex) += path;
}

void ExplicitMotion::start_next() noexcept {
  if (tensors_.parts() == 1 || columns_ != 1 || begun_) return;
  begun_ = true;
  team_.begin(static_cast<std::uint32_t>(tensors_.parts()), multiply_part_);
}

void ExplicitMotion::drop_next() noexcept {
  if (!begun_) return;
  multiply();
  for (std::size_t p = 0; p < tensors_.parts(); ++p) tensors_.gather_part(p, resistance_.data(), ahead_);
}

/// `work(part, begin, end)` for the vertices of each part of a product, on as many cores.
template <class Work>
void ExplicitMotion::for_parts(const Work& work) noexcept {
  team_.run(static_cast<std::uint32_t>(tensors_.parts()), [&](std::uint32_t p) {
    const auto [begin, end] = tensors_.rows_of_part(p);
    work(p, static_cast<std::size_t>(begin), static_cast<std::size_t>(end));
  });
}

void ExplicitMotion::MultiplyPart::operator()(std::uint32_t part) const noexcept {
  of.tensors_.multiply_part(part, of.bent_.data(), of.resistance_.data(), of.ahead_);
}

/// Multiplies, or finishes a product that was started, which then also is of what kicks did.
void ExplicitMotion::multiply() noexcept {
  if (!begun_) return team_.run(static_cast<std::uint32_t>(tensors_.parts()), multiply_part_);
  team_.finish();
  begun_ = false;
  for (const auto& [place, path] : kicks_) {
    tensors_.add_product(place, path, resistance_.data());
    Eigen::Map<Vec3>(bent_.data() + std::ptrdiff_t{ElasticTensors::kNumbersPerVertex} * place) += path;
  }
  kicks_.clear();
}

void ExplicitMotion::sub_step(double h, const std::vector<double>& force) noexcept {
  if (!floating_.empty()) return sub_step_floating(h, force);
  if (columns_ == 1) {
    multiply();
    for_parts([&](std::size_t p, std::size_t begin, std::size_t end) {
      tensors_.gather_part(p, resistance_.data(), ahead_);
      advance<1>(begin, end, h, force.data());
    });
  } else {
    tensors_.multiply_wide(bent_.data(), resistance_.data());
    advance<ElasticTensors::kWide>(0, tensors_.masses().size(), h, force.data());
  }
}

/// As `sub_step`, of one motion; K acts on floating pieces in their frames.
void ExplicitMotion::sub_step_floating(double h, const std::vector<double>& force) noexcept {
  multiply();
  for_parts(
      [&](std::size_t p, std::size_t, std::size_t) { tensors_.gather_part(p, resistance_.data(), ahead_); });
  floating_.turn_forces(frames_, {state.u.data()}, {resistance_.data(), ElasticTensors::kNumbersPerVertex});
  for_parts(
      [&](std::size_t, std::size_t begin, std::size_t end) { advance<1>(begin, end, h, force.data()); });
  turn_bent();
}

/// Finds the frames of floating pieces, and the displacement in them that the next product is of.
void ExplicitMotion::turn_bent() noexcept {
  floating_.find_frames({state.u.data()}, frames_);
  for (std::size_t p = 0; p < frames_.size(); ++p) {
    for (const FloatingPieces::Node& node : floating_.piece(p)) {
      const std::ptrdiff_t first = std::ptrdiff_t{3} * node.number,
                           numbers_per_vertex =
                               std::ptrdiff_t{ElasticTensors::kNumbersPerVertex} * node.number;
      const Eigen::Map<const Vec3> u(state.u.data() + first), v(state.v.data() + first);
      Eigen::Map<Vec3>(bent_.data() + numbers_per_vertex) = FloatingPieces::turned_back(node, frames_[p], u) +
                                                            damping_.stiffness * frames_[p].R.transpose() * v;
    }
  }
}

template <int kColumns>
void ExplicitMotion::advance(std::size_t begin, std::size_t end, double h,
                             const double* __restrict force) noexcept {
  const double keep = 1 - h * damping_.mass, stiffness = damping_.stiffness;
  const double* __restrict masses = tensors_.masses().data(), * __restrict resistance = resistance_.data();
  double* __restrict u = state.u.data(), * __restrict v = state.v.data(), * __restrict bent = bent_.data();
  constexpr std::size_t kNumbers = 3 * kColumns;  // of a vertex
  // From a vertex to the next in `bent_` and `resistance_`, which are padded where there is one motion.
  constexpr std::size_t kFar = kColumns == 1 ? ElasticTensors::kNumbersPerVertex : kNumbers;
  for (std::size_t vertex = begin; vertex < end; ++vertex) {
    const double add_impulse = h / masses[vertex];
    for (std::size_t i = 0; i < kNumbers; ++i) {
      const std::size_t k = kNumbers * vertex + i, numbers_per_vertex = kFar * vertex + i;
      v[k] = keep * v[k] + add_impulse * (force[k] - resistance[numbers_per_vertex]);
      u[k] += h * v[k];
      bent[numbers_per_vertex] = u[k] + stiffness * v[k];
    }
  }
}

/// Updates, of vertices `begin` to `end`, the displacement that the next product is of.
void ExplicitMotion::bend(std::size_t begin, std::size_t end) noexcept {
  const std::size_t numbers = 3 * static_cast<std::size_t>(columns_), far = numbers_per_vertex();
  for (std::size_t vertex = begin; vertex < end; ++vertex) {
    for (std::size_t i = 0; i < numbers; ++i) {
      const std::size_t k = numbers * vertex + i;
      bent_[far * vertex + i] = state.u[k] + damping_.stiffness * state.v[k];
    }
  }
}

void ExplicitMotion::run(double h) noexcept {
  drop_next();
  for_parts([&](std::size_t, std::size_t begin, std::size_t end) { bend(begin, end); });
  turn_bent();
  sub_step(h, state.f);
}

void ExplicitMotion::run_free(State& before, double h) noexcept {
  drop_next();
  std::swap(before, state);
  multiply();
  const double keep = 1 - h * damping_.mass;
  for_parts([&](std::size_t p, std::size_t begin, std::size_t end) {
    tensors_.gather_part(p, resistance_.data(), ahead_);
    for (std::size_t vertex = begin; vertex < end; ++vertex) {
      const double add_impulse = h / tensors_.masses()[vertex];
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t k = 3 * vertex + i,
                          numbers_per_vertex = ElasticTensors::kNumbersPerVertex * vertex + i;
        state.v[k] = keep * before.v[k] - add_impulse * resistance_[numbers_per_vertex];
        state.u[k] = before.u[k] + h * state.v[k];
        state.f[k] = 0;
        bent_[numbers_per_vertex] = state.u[k] + damping_.stiffness * state.v[k];
      }
    }
  });
}

void ExplicitMotion::run(int steps, double h, const std::vector<double>& force) noexcept {
  drop_next();
  std::vector<double>& f = state.f;
  const std::size_t numbers = 3 * static_cast<std::size_t>(columns_);  // of a vertex
  for_parts([&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t k = numbers * begin; k < numbers * end; ++k) f[k] = 0.5 * (f[k] + force[k]);
    bend(begin, end);
  });
  sub_step(h, f);
  for (int i = 1; i < steps; ++i) sub_step(h, force);
  for_parts([&](std::size_t, std::size_t begin, std::size_t end) {
    std::copy_n(force.data() + numbers * begin, numbers * (end - begin), f.data() + numbers * begin);
  });
}

}  // namespace palpate::sim
