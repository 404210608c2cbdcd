// A string round a rough drum against the equation of Euler and Eytelwein: T2 = T1 exp(mu phi).
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/contact/contact_solver.h"
#include "tests/support/catch.h"

using namespace palpate;

namespace {

constexpr double kDrumRadius = 0.005, kDrumMu = 0.3, kQuarter = std::numbers::pi / 2;

/// A string of equal springs without natural length between two anchors in the plane z = 0, over a capsule
/// along z. The tension of such a spring is its stiffness times its length, and its force is linear in the
/// places of its ends however far it turns: the compliance of the free nodes is Green's function of the
/// discrete string, and the string has no bending stiffness. The springs are edges of a fan of triangles,
/// whose other corner is fixed far outside. The string meets the capsule over a quarter of its turn: both
/// free spans are 4 mm long and at 45 degrees to the horizontal.
class StringOverDrum {
 public:
  explicit StringOverDrum(int springs)
      : springs_(springs), stiffness_(10.0 * springs), solver_(springs, kFeatures * springs, true) {
    const int free = springs - 1;
    patch_.reserve(springs, springs);
    patch_.compliance.setZero();
    for (int i = 0; i < free; ++i) {
      for (int j = 0; j < free; ++j) {
        const double green = (std::min(i, j) + 1.0) * (free - std::max(i, j)) / (stiffness_ * springs);
        patch_.compliance.block<3, 3>(3 * i, 3 * j) = green * Mat3::Identity();
      }
    }
    for (int i = 0; i + 1 < free; ++i) patch_.triangles.push_back({i, i + 1, free});
    place();
    nodes_ = patch_.free;
    u_ = Eigen::VectorXd::Zero(3 * (springs + 1));
    // From below the straight string upwards, without friction: then all tensions are equal.
    const double touch = right_[1] - kDrumRadius;
    tip_ = height(touch);
    for (int i = 0; i <= 40; ++i) go({height(touch * (1 - i / 40.0)), Quat::Identity()}, 0);
  }

  /// Moves the right anchor outwards along its span.
  void pull(double by) {
    const Vec3 way = by * Vec3(std::cos(0.5 * kQuarter), -std::sin(0.5 * kQuarter), 0);
    right_ += way;
    for (int i = 1; i < springs_; ++i)  // from where the nodes are
      u_.segment<3>(3 * (i - 1)) -= static_cast<double>(i) / springs_ * way;
    place();
    go({tip_, turn_}, kDrumMu);
  }
  /// Turns the drum about its axis, to the right at its top.
  void turn(double by) { go({tip_, Quat(Eigen::AngleAxisd(-by, Vec3::UnitZ())) * turn_}, kDrumMu); }

  /// Force of a spring on its left end, N; springs are numbered from the left.
  Vec3 pull_of(int spring) const {
    const Vec3& from = spring == 0 ? left_ : nodes_[spring - 1];
    const Vec3& to = spring + 1 == springs_ ? right_ : nodes_[spring];
    return stiffness_ * (to - from);
  }
  double tension(int spring) const { return pull_of(spring).norm(); }
  /// Angle between two springs, rad.
  double angle(int a, int b) const {
    return std::atan2(pull_of(a).cross(pull_of(b)).norm(), pull_of(a).dot(pull_of(b)));
  }
  int last() const { return springs_ - 1; }
  double ratio() const { return tension(last()) / tension(0); }
  const Vec3& middle() const { return nodes_[springs_ / 2 - 1]; }
  const ContactForce& on_drum() const { return on_drum_; }
  bool converged() const { return converged_; }

 private:
  static Vec3 height(double y) { return {0, y, -0.5 * kLength}; }
  void place() {
    patch_.free.clear();
    for (int i = 1; i < springs_; ++i)
      patch_.free.push_back(left_ + static_cast<double>(i) / springs_ * (right_ - left_));
    patch_.free.push_back(Vec3(0, 10 * kDrumRadius, 0));
  }
  void go(const ToolPose& pose, double friction) {
    const Tool drum{kDrumRadius, friction, kLength};
    on_drum_ = solver_.solve(patch_, drum, pose, u_, {nodes_, tip_, turn_});
    converged_ = converged_ && on_drum_.converged;
    for (int i = 0; i < springs_; ++i) nodes_[i] = patch_.free[i] + u_.segment<3>(3 * i);
    tip_ = pose.p_W + u_.tail<3>();
    turn_ = pose.q_W;
  }

  static constexpr double kLength = 0.02, kSpan = 0.004;  // m
  // The solver keeps as many contacts as triangles. Near a shaft are two edges and a vertex of each.
  static constexpr int kFeatures = 3;
  int springs_;
  double stiffness_;  // N/m, of each
  ContactSolver solver_;
  ContactPatch patch_;
  Vec3 right_ = Vec3(kDrumRadius + kSpan, kDrumRadius - kSpan, 0) * std::numbers::sqrt2 / 2,
       left_ = Vec3(-right_[0], right_[1], 0);
  std::vector<Vec3> nodes_;
  Eigen::VectorXd u_;
  Vec3 tip_;
  Quat turn_ = Quat::Identity();
  ContactForce on_drum_;
  bool converged_ = true;
};

/// Largest difference of the ratio of tensions from exp(mu phi), of it, once the string slides everywhere;
/// and checks of the tensions until then.
double worst_of_capstan(int springs, int increments) {
  StringOverDrum string(springs);
  const double even = string.tension(0);
  CHECK(string.ratio() == Approx(1).epsilon(1e-8));
  CHECK(string.angle(0, string.last()) == Approx(kQuarter).epsilon(0.01));
  double worst = 0;
  int held = 0, slid = 0;
  for (int i = 1; i <= increments; ++i) {
    string.pull(0.012 / increments);
    REQUIRE(string.converged());
    const double end = string.tension(string.last()), phi = string.angle(0, string.last()),
                 most = std::exp(kDrumMu * phi);
    CAPTURE(springs, i, end / even, string.tension(0) / even, string.ratio() / most);
    if (end < 0.98 * most * even) {
      ++held;
      CHECK(string.tension(0) == Approx(even).epsilon(1e-4));  // nothing has arrived there
      double off = 0;
      for (int spring = 0; spring < springs; ++spring) {
        const double slips = end * std::exp(-kDrumMu * string.angle(spring, string.last()));
        off = std::max(off, std::abs(string.tension(spring) / std::max(even, slips) - 1));
      }
      CHECK(off < 0.02);
    } else if (end > 1.03 * most * even) {
      ++slid;
      worst = std::max(worst, std::abs(string.ratio() / most - 1));
    }
  }
  CHECK(held >= increments / 4);
  CHECK(slid >= increments / 4);
  return worst;
}

}  // namespace

TEST_CASE("capstan: a string pulled over a rough drum holds, slips from its end inwards, then slides") {
  // Its chords are tangents of the drum, so the error falls as the square of their length.
  const double coarse = worst_of_capstan(20, 20), medium = worst_of_capstan(40, 20),
               fine = worst_of_capstan(80, 20);
  CAPTURE(coarse, medium, fine);
  CHECK(coarse < 0.02);
  CHECK(medium < 0.5 * coarse);
  CHECK(fine < 0.5 * medium);
}

TEST_CASE("capstan: the increments of the pull do not matter") {
  for (const int increments : {8, 100}) CHECK(worst_of_capstan(40, increments) < 0.01);
}

TEST_CASE("capstan: a drum that turns carries its string along until it slides") {
  StringOverDrum string(40);
  const double even = string.tension(0);
  const Vec3 top = string.middle();
  string.turn(0.02);
  // Held by less than friction can hold: the top of the string goes with the drum.
  CHECK(string.middle()[0] - top[0] == Approx(0.02 * top[1]).epsilon(0.01));
  CHECK(string.ratio() > 1.1 * std::exp(-kDrumMu * kQuarter));
  for (const double by : {0.04, 0.1, 0.3, 0.01, 0.5}) string.turn(by);
  for (const double by : {0.2, 0.01, 0.4}) {
    string.turn(by);
    REQUIRE(string.converged());
    const double least = std::exp(-kDrumMu * string.angle(0, string.last())), left = string.tension(0),
                 right = string.tension(string.last());
    CAPTURE(by, left / even, right / even);
    CHECK(string.ratio() == Approx(least).epsilon(0.01));
    CHECK((string.on_drum().force - string.pull_of(string.last()) + string.pull_of(0)).norm() < 1e-6 * left);
    CHECK(string.on_drum().torque[2] == Approx(kDrumRadius * (left - right)).epsilon(0.01));
  }
}
