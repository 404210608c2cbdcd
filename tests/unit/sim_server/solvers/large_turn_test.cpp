// Bodies that turn far: as a whole, and twisted by a quarter.
#include <numbers>

#include "sim_server/solvers/equilibrium.h"
#include "tests/support/catch.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::array kTurning{ElasticLaw::kCorotational, ElasticLaw::kStVenantKirchhoff,
                              ElasticLaw::kNeoHookean};
constexpr std::array kElements{ElementKind::kLinear, ElementKind::kNodalPressure, ElementKind::kQuadratic};

Mat3 turn_about(const Vec3& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

double volume(const Solid& solid, std::span<const Vec3> x) {
  std::vector<Solid::State> states(solid.points());
  solid.evaluate(x, states);
  double sum = 0;
  for (std::size_t p = 0; p < states.size(); ++p) sum += states[p].F.determinant() * solid.volume_of(p);
  return sum;
}

std::vector<Vec3> forces(const Solid& solid, std::span<const Vec3> x) {
  std::vector<Vec3> f(x.size());
  solid.forces(x, f);
  return f;
}

/// A bar of radius r along y from 0 to L, both ends held, of which the upper one is turned about y.
class TwistedBar {
 public:
  static constexpr double kRadius = 0.01, kLength = 0.04;

  TwistedBar(const Material& material, int across, int along)
      : solid_(with_nodes(mapped(grid_block(lines(-kRadius, kRadius, across), lines(0, kLength, along),
                                            lines(-kRadius, kRadius, across)),
                                 square_to_disc),
                          material.element),
               material),
        x_(solid_.rest()) {
    for (const Vec3& x : solid_.rest()) held_.push_back(x[1] == 0 || at_top(x) ? kAllAxes : 0);
  }
  /// Goes on from where it is.
  void twist(double angle) {
    for (std::size_t i = 0; i < x_.size(); ++i) {
      const Vec3& rest = solid_.rest()[i];
      if (at_top(rest))
        x_[i] = turn_about(Vec3::UnitY(), angle) * rest;
      else if (held_[i] == 0)  // those below go along by their share
        x_[i] = turn_about(Vec3::UnitY(), (angle - angle_) * rest[1] / kLength) * x_[i];
    }
    angle_ = angle;
    x_ = find_equilibrium(solid_, {.held = held_, .start = x_}, "test").x;
  }
  /// About y, that holds the upper end, N m.
  double torque() const {
    const std::vector<Vec3> f = forces(solid_, x_);
    double sum = 0;
    for (std::size_t i = 0; i < f.size(); ++i) {
      if (at_top(solid_.rest()[i])) sum += x_[i].cross(f[i])[1];
    }
    return sum;
  }
  double energy() const { return solid_.energy(x_); }
  double volume_now() const { return volume(solid_, x_); }
  double volume_at_rest() const { return volume(solid_, solid_.rest()); }

 private:
  static bool at_top(const Vec3& x) { return x[1] > 0.999 * kLength; }
  Solid solid_;
  std::vector<HeldAxes> held_;
  std::vector<Vec3> x_;
  double angle_ = 0;
};

}  // namespace

TEST_CASE(
    "large turn: turned by a quarter as a whole, a bent bar keeps its volume, its energy and its forces") {
  for (const ElasticLaw law : kTurning) {
    for (const ElementKind element : kElements) {
      const Solid solid(
          with_nodes(grid_block(lines(0, 0.1, 3), lines(0, 0.03, 2), lines(0, 0.03, 2)), element),
          {1e4, 0.4, 1000, law, element, {}, {}});
      std::vector<Vec3> bent = solid.rest(), turned;
      for (Vec3& x : bent) x += Vec3(0.2 * x[0] * x[1], 2 * x[0] * x[0], -0.5 * x[0] * x[2]);
      const Mat3 turn = turn_about(Vec3(1, 2, -1), kPi / 2);
      for (const Vec3& x : bent) turned.push_back(turn * x + Vec3(0.02, 0, 0.01));
      CHECK(volume(solid, turned) == Approx(volume(solid, bent)).epsilon(1e-10));
      CHECK(solid.energy(turned) == Approx(solid.energy(bent)).epsilon(1e-9));
      const std::vector<Vec3> before = forces(solid, bent), after = forces(solid, turned);
      double off = 0, most = 0;
      for (std::size_t i = 0; i < before.size(); ++i) {
        off = std::max(off, (turn * before[i] - after[i]).norm());
        most = std::max(most, before[i].norm());
      }
      CAPTURE(static_cast<int>(law), static_cast<int>(element));
      REQUIRE(most > 0.01);
      CHECK(off < 1e-9 * most);
    }
  }
}

TEST_CASE("large turn: a round bar twisted a little has the torque G J theta / L, and converges to it") {
  // St Venant 1855: a round section does not warp, so that held ends change nothing.
  const Material tissue{1e4, 0.3, 1000, ElasticLaw::kCorotational, ElementKind::kQuadratic, {}, {}};
  constexpr double kAngle = 1e-4;
  const double exact =
      tissue.lame_mu() * kPi / 2 * std::pow(TwistedBar::kRadius, 4) * kAngle / TwistedBar::kLength;
  const auto error = [&](int across) {
    TwistedBar bar(tissue, across, across);
    bar.twist(kAngle);
    return std::abs(bar.torque() / exact - 1);
  };
  const double coarse = error(4), fine = error(8);
  CAPTURE(coarse, fine);
  CHECK(fine < 0.02);
  CHECK(std::log2(coarse / fine) == Approx(2).margin(0.4));  // the section is a polygon
}

TEST_CASE("large turn: twisted by a quarter, the torque is the slope of the energy, under every law") {
  for (const ElasticLaw law : {ElasticLaw::kCorotational, ElasticLaw::kNeoHookean}) {
    for (const ElementKind element : kElements) {
      TwistedBar bar({1e4, 0.4, 1000, law, element, {}, {}}, 4, 6);
      for (int i = 1; i <= 6; ++i) bar.twist(i * kPi / 12);
      const double torque = bar.torque();
      constexpr double kStep = 1e-3;
      bar.twist(kPi / 2 + kStep);
      const double more = bar.energy();
      bar.twist(kPi / 2 - kStep);
      const double slope = (more - bar.energy()) / (2 * kStep);
      CAPTURE(static_cast<int>(law), static_cast<int>(element), torque);
      CHECK(torque > 1e-4);
      CHECK(slope == Approx(torque).epsilon(1e-5));
    }
  }
}

TEST_CASE("large turn: a neo-Hookean bar that keeps its volume, twisted by a quarter (Rivlin)") {
  // Rivlin 1949: a round bar of fixed length that keeps its volume twists without moving else, and with W of
  // I = 3 + (theta r / L)^2 alone the torque is 4 pi theta / L times the integral of W'(I) r^3. Of the stable
  // neo-Hookean energy W' = m / 2 (1 - 1 / (I + 1)), m = 4/3 mu.
  const auto error = [&](int across) {
    const Material tissue{1e4, 0.4995, 1000, ElasticLaw::kNeoHookean, ElementKind::kQuadratic, {}, {}};
    const double twist = kPi / 2 / TwistedBar::kLength, r = TwistedBar::kRadius;
    double exact = 0;
    constexpr int kParts = 1000;
    for (int i = 0; i < kParts; ++i) {
      const double at = (i + 0.5) * r / kParts, square = 3 + twist * twist * at * at;
      exact += 4 * kPi * twist * 2.0 / 3 * tissue.lame_mu() * (1 - 1 / (square + 1)) * std::pow(at, 3) * r /
               kParts;
    }
    TwistedBar bar(tissue, across, across / 2);
    for (int i = 1; i <= 3; ++i) bar.twist(i * kPi / 6);
    CHECK(bar.volume_now() == Approx(bar.volume_at_rest()).epsilon(1e-3));
    return std::abs(bar.torque() / exact - 1);
  };
  const double coarse = error(4), fine = error(8);
  CAPTURE(coarse, fine);
  CHECK(fine < 0.03);
  CHECK(coarse > 2.5 * fine);
}
