#pragma once
/// A law that listens to the served block while its tool slides over it, and how far off it is.
#include <cmath>
#include <functional>
#include <numbers>

#include "haptic_client/extrapolation/local_contact.h"
#include "tests/support/served_block.h"

namespace palpate::test {

constexpr Time kTick = std::chrono::milliseconds(2);
inline const auto kEntireModel = [](protocol::SurfacePage&) { return true; };

/// Slides over the block, 1 to 2 mm deep, turning at its ends; leaves it once in each 0.8 s.
inline Vec3 slide(Time t) {
  const double s = to_seconds(t), turn = 2 * std::numbers::pi / 0.8;
  const double height = 0.0035 + 0.0045 * std::max(std::cos(turn * s) - 0.6, 0.0) + 0.0005 * std::sin(7 * s);
  return {0.006 * std::sin(4 * s), height, 0.004 * std::cos(3 * s)};
}

/// A law that listens to the block with a tool that moves.
struct Listener {
  explicit Listener(Time delay = std::chrono::milliseconds(35), std::size_t tools = 1,
                    Time period = ServedBlock::kPeriod)
      : block(delay, tools, period) {}
  Listener(const sim::Scene& scene, sim::TetMesh mesh)
      : block(scene, std::move(mesh), std::chrono::milliseconds(35)) {}

  /// Gives the model to the law, each page as `change` leaves it; false leaves it out.
  template <class Change>
  void learn(Change change) {
    const sim::SurfacePager pager(block.simulation, 0);
    model.announce(pager.state(), pager.pages().modes);
    for (protocol::SurfacePage page : all_pages(block.simulation)) {
      if (change(page)) model.take(page);
    }
  }
  Vec3 tick(const Vec3& p) {
    const Vec3 v = (p - place) / to_seconds(kTick);
    place = p;
    t += kTick;
    if (auto sample = block.exchange(t, p, v)) {
      published(*sample);
      law.take(client::sample_of(*sample, &model), p, t);
      newest = *sample;
    }
    return law.force(p, t);
  }

  ServedBlock block;
  client::SurfaceModel model;
  client::ForceEstimate law{std::make_unique<client::LocalContact>()};
  protocol::ForceSample newest;
  std::function<void(protocol::ForceSample&)> published = [](protocol::ForceSample&) {
  };  ///< changes what it hears
  Time t = std::chrono::seconds(1);
  Vec3 place = slide(t);
};

/// Error of a law over 3 s of the slide, against the simulation at every tick, as a share of the peak force.
struct Errors {
  double mean = 0, largest = 0;
};
template <class L>
Errors follow(L& listener, Time duration = std::chrono::seconds(3)) {
  sim::Simulation truth(block_scene(), block_mesh());
  double sum = 0, largest = 0, peak = 0;
  int ticks = 0;
  for (const Time end = listener.t + duration; listener.t < end; ++ticks) {
    const Vec3 p = slide(listener.t + kTick);
    const Vec3 right = truth.step(p, 0.002).force, given = listener.tick(p);
    peak = std::max(peak, right.norm());
    if (listener.newest.number < 3) continue;
    sum += (given - right).norm();
    largest = std::max(largest, (given - right).norm());
  }
  return {sum / ticks / peak, largest / peak};
}

}  // namespace palpate::test
