#pragma once
/// Who holds the tool in the study of stability, over what, and how it is judged.
#include <string>

#include "haptic_client/device/simulated_operator.h"
#include "haptic_client/pipeline/pipeline.h"
#include "tests/support/closed_loop.h"

namespace palpate::studies {

constexpr double kHapticHz = 1000;
constexpr double kPress = 1.5;      // N, that the hand settles at
constexpr double kEncoder = 20e-6;  // m
constexpr double kClamp = 12;       // N
constexpr int kSeeds = 5;
constexpr const char* kDirect = "direct";  // the true force at the haptic rate, without a law or a link

struct Person {
  const char* name;
  client::OperatorSettings hand;
};

struct Link {
  double rate_hz, delay_ms;
};

struct Cell {
  const Person* person;
  std::string law, world;
  bool passivity;
  Link link;
  double compliance = 1;  // the client is told so many times that of the tissue
};

struct Outcome {
  bool stable = false;
  double force_error = 0;  // RMS, of the RMS of the true force
};

/// What the encoder tells of a hand.
class Encoder : public client::Device {
 public:
  Encoder(client::Device& hand, double offset) : hand_(hand), offset_(offset) {}
  client::DeviceReading read(Time now) noexcept override {
    client::DeviceReading reading = hand_.read(now);
    place_ = reading.p_D;
    for (double& x : reading.p_D) x = kEncoder * std::round((x - offset_) / kEncoder) + offset_;
    return reading;
  }
  void write(const Vec3& f_D) noexcept override { hand_.write(f_D); }
  /// Where the hand really is, m.
  const Vec3& place() const { return place_; }

 private:
  client::Device& hand_;
  double offset_;
  Vec3 place_ = Vec3::Zero();
};

/// Of a device that can give `kClamp`.
inline Vec3 clamped(const Vec3& f) {
  return f.norm() > kClamp ? Vec3(kClamp * f.normalized()) : f;
}

inline test::ClosedLoopSettings loop_of(const Link& link, int seed) {
  return {.haptic_hz = kHapticHz,
          .sim_hz = link.rate_hz,
          .link = {.delay = link.delay_ms / 1e3},
          .seed = static_cast<std::uint64_t>(seed)};
}

/// The client of a cell; the `law` must be one of `extrapolators()`.
client::Pipeline pipeline_of(const Cell& cell);

}  // namespace palpate::studies
