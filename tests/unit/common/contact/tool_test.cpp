// Tools with an axis: capsules, and shafts that pivot.
#include "common/contact/tool.h"

#include "common/contact/contact_solver.h"
#include "common/contact/simplex_distance.h"
#include "tests/support/catch.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/random.h"

using namespace palpate;

namespace {

/// Nodes on springs of compliance c, uncoupled: an edge along z at x, y = 0, and a third corner far below.
ContactPatch ridge(double x, double c) {
  ContactPatch patch;
  patch.reserve(3, 1);
  patch.free = {{x, 0, -0.02}, {x, 0, 0.02}, {x, -0.1, 0}};
  patch.triangles = {{0, 1, 2}};
  patch.compliance.setIdentity();
  patch.compliance *= c;
  return patch;
}

/// A plane of 6 x 6 nodes 4 mm apart on springs, y = 0.
ContactPatch plane(double c) {
  ContactPatch patch;
  patch.reserve(36, 50);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) patch.free.push_back(Vec3(0.004 * i - 0.01, 0, 0.004 * j - 0.01));
  }
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 5; ++j) {
      const int a = 6 * i + j, b = a + 6;
      patch.triangles.push_back({a, a + 1, b});
      patch.triangles.push_back({b, a + 1, b + 1});
    }
  }
  patch.compliance.setIdentity();
  patch.compliance *= c;
  return patch;
}

struct Bench {
  Bench(ContactPatch on, const Tool& with)
      : patch(std::move(on)),
        tool(with),
        solver(patch.nodes(), 4 * static_cast<int>(patch.triangles.size()), with.friction > 0),
        u(Eigen::VectorXd::Zero(3 * (patch.nodes() + 1))) {}
  ContactForce at(const ToolPose& pose, const ToolPose& from) {
    u.setZero();
    return solver.solve(patch, tool, pose, u, {patch.free, from.p_W, from.q_W});
  }
  ContactForce at(const ToolPose& pose) { return at(pose, pose); }
  double energy() const {
    const auto f = solver.node_forces();
    return 0.5 * f.dot(patch.compliance.topLeftCorner(f.size(), f.size()) * f);
  }
  ContactPatch patch;
  Tool tool;
  ContactSolver solver;
  Eigen::VectorXd u;
};

Tool capsule(double friction = 0) {
  return {.radius = 0.002, .friction = friction, .length = 0.016};
}

/// Across the plane from above on the left, its tip beyond the ridge.
Tool instrument(double friction = 0) {
  return {.radius = 0.003, .friction = friction, .trocar = Tool::Trocar{Vec3(-0.1, 0.03, 0), 0.002}};
}

/// Along +x, tilted by `tilt` (rad) about z, tip left.
ToolPose lying(double height, double tilt) {
  const Vec3 way(std::cos(tilt), std::sin(tilt), 0);
  return {Vec3(-0.008, height, 0.0003), test::turn_between(Vec3::UnitZ(), way)};
}

double sampled_distance(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  double best = 1e9;
  for (int i = 0; i <= 400; ++i) {
    const Vec3 x = p + i / 400.0 * (q - p);
    const auto w = closest_point(x, a, b, c).weight;
    best = std::min(best, (x - w[0] * a - w[1] * b - w[2] * c).norm());
  }
  return best;
}

}  // namespace

TEST_CASE("the distance between a segment and a triangle, and between segments, against sampling") {
  test::Random random(1);
  int crossing = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 p = random.vector(1), q = random.vector(1), a = random.vector(1), b = random.vector(1),
               c = random.vector(1);
    const double distance = segment_triangle_distance(p, q, a, b, c),
                 sampled = sampled_distance(p, q, a, b, c);
    CHECK(distance <= sampled + 1e-12);
    CHECK(distance > sampled - 0.01);
    crossing += distance == 0 ? 1 : 0;
    const ClosestPair pair = closest_pair(p, q, a, b);
    const double apart = (p + pair.on_first * (q - p) - a - pair.on_second * (b - a)).norm();
    CHECK(apart <= sampled_distance(p, q, a, b, b) + 1e-12);
  }
  CHECK(crossing > 10);
  const ClosestPair parallel = closest_pair({0, 0, 0}, {4, 0, 0}, {5, 1, 0}, {1, 1, 0});
  CHECK(parallel.on_first == Approx(0.625));  // the middle of 1 .. 4
  CHECK(parallel.on_second == Approx(0.625));
}

TEST_CASE("the Hessian of the distance to an edge or a vertex of what slides along an axis, or pivots") {
  test::Random random(6);
  constexpr double kStep = 1e-4;
  for (int i = 0; i < 20; ++i) {
    const bool pivots = i % 2 == 0;
    const int m = 1 + (i / 2) % 2;
    std::vector<Vec3> y;
    for (int j = 0; j <= m; ++j) y.push_back(random.vector(1));
    const Vec3 pivot = random.vector(1) + Vec3(3, 0, 0), direction = random.vector(1).normalized();
    // Lines without ends: the distance is smooth everywhere.
    const auto solve = [&](const std::vector<Vec3>& at) {
      Eigen::MatrixXd e(3, m);
      const Vec3 axis = pivots ? Vec3(at[m] - pivot) : direction;
      e.col(0) = axis;
      if (m == 2) e.col(1) = -(at[1] - at[0]);
      const Vec3 from = (pivots ? pivot : at[m]) - at[0];
      const Eigen::VectorXd free = -test::solve_definite(e.transpose() * e, e.transpose() * from);
      return std::pair<Eigen::VectorXd, Vec3>(free, from + e * free);
    };
    const auto [free, rho] = solve(y);
    std::array<double, 3> weight{1, 0, 0};
    if (m == 2) weight = {1 - free[1], free[1], 0};
    const SlidingPoint sliding{pivots ? Vec3(y[m] - pivot) : direction, pivots ? free[0] : 1.0, pivots};
    WeightGradient gradient;
    const SimplexHessian h = distance_hessian({y.data(), static_cast<std::size_t>(m)},
                                              {weight.data(), static_cast<std::size_t>(m)}, rho.normalized(),
                                              rho.norm(), &gradient, &sliding);
    for (int r = 0; r < 3 * (m + 1); ++r) {
      for (int c = 0; c < 3 * (m + 1); ++c) {
        const auto at = [&](double dr, double dc) {
          auto moved = y;
          moved[r / 3][r % 3] += dr;
          moved[c / 3][c % 3] += dc;
          return solve(moved).second.norm();
        };
        const double difference =
            (at(kStep, kStep) - at(kStep, -kStep) - at(-kStep, kStep) + at(-kStep, -kStep)) /
            (4 * kStep * kStep);
        CHECK(h(r, c) == Approx(difference).margin(1e-4 * (1 + h.cwiseAbs().maxCoeff())));
      }
    }
  }
}

TEST_CASE("a trocar: what touches the shaft halfway is felt with half its force, at the tip with all of it") {
  // The pivot 100 mm from the ridge and the tip 100 mm beyond it, all level: lever 1/2.
  const Tool tool{.radius = 0.003, .trocar = Tool::Trocar{Vec3(-0.1, 0.0015, 0), 0.002}};
  Bench bench(ridge(0, 1e-3), tool);
  const ContactForce force = bench.at(Vec3(0.1, 0.0015, 0));
  REQUIRE(force.contacts == 1);
  const auto nodes = bench.solver.node_forces();
  const Vec3 on_shaft = -(nodes.segment<3>(0) + nodes.segment<3>(3) + nodes.segment<3>(6));
  CHECK(on_shaft[1] == Approx(0.0005 / (1e-3 / 2)).epsilon(1e-4));  // two springs share it
  CHECK((force.force - 0.5 * on_shaft).norm() < 1e-9);
  CHECK(force.torque == Vec3::Zero());
  Bench at_tip(ridge(0.1, 1e-3), tool);
  const ContactForce entire = at_tip.at(Vec3(0.1, 0.0025, 0));
  REQUIRE(entire.contacts == 1);
  CHECK(entire.force[1] == Approx(0.0005 / (1e-3 / 2)).epsilon(1e-4));
}

TEST_CASE("a trocar: force along the shaft and across it do the work of the contact (virtual work)") {
  // Exact for a rigid shaft: x(p) of a point held in the frame of the shaft, by finite differences.
  const Vec3 pivot(-0.1, 0.03, 0.01), p(0.02, -0.004, 0.003);
  const double ahead = (p - pivot).norm();
  test::Random random(2);
  for (int i = 0; i < 50; ++i) {
    const double s = random.between(0.1, 1);
    const Contact contact{{0, -1, -1},  {1, 0, 0}, 1, Contact::kShaft, Vec3::UnitY(), 0.002, 0.002,
                          Vec3::Zero(), p - pivot, s};
    const Vec3 f = random.vector(1), dp = random.vector(1);
    const auto place = [&](const Vec3& tip) {
      // s of the first length along the shaft, and with it when it is pushed in.
      const Vec3 a = (tip - pivot).normalized();
      return Vec3(tip - (1 - s) * ahead * a);
    };
    constexpr double kStep = 1e-7;
    const Vec3 dx = (place(p + kStep * dp) - place(p - kStep * dp)) / (2 * kStep);
    CHECK(contact.at_tip(f).dot(dp) == Approx(f.dot(dx)).epsilon(1e-6).margin(1e-8));
  }
}

TEST_CASE("capsules and trocars: force is the slope of the energy in the tissue") {
  constexpr double kStep = 1e-8;
  const auto check = [&](Bench bench, const ToolPose& pose) {
    const ContactForce force = bench.at(pose);
    CHECK(force.converged);
    CHECK(force.contacts > 0);
    for (int axis = 0; axis < 3; ++axis) {
      ToolPose ahead = pose, behind = pose;
      ahead.p_W[axis] += kStep;
      behind.p_W[axis] -= kStep;
      bench.at(ahead);
      const double more = bench.energy();
      bench.at(behind);
      CHECK(force.force[axis] ==
            Approx(-(more - bench.energy()) / (2 * kStep)).margin(2e-4 * force.force.norm()));
    }
  };
  check(Bench(plane(1e-3), capsule()), lying(0.0015, 0.02));
  check(Bench(plane(1e-3), capsule()), lying(0.0012, -0.03));
  check(Bench(plane(1e-3), capsule()), lying(0.0017, 0.6));
  check(Bench(plane(1e-3), instrument()), Vec3(0.004, 0.0024, 0.0011));
  check(Bench(ridge(-0.02, 1e-3), instrument()), Vec3(0.02, -0.0125, 0.0011));
}

TEST_CASE("capsules and trocars: the tangent agrees with finite differences, slipping and not") {
  constexpr double kStep = 1e-9;
  const auto check = [&](Bench bench, const ToolPose& pose, const Vec3& slide) {
    const ToolPose from(pose.p_W - slide, pose.q_W);
    REQUIRE(bench.at(pose, from).contacts > 0);
    const Mat3 tangent = bench.solver.tangent(bench.patch);
    Mat3 slope;
    for (int axis = 0; axis < 3; ++axis) {
      ToolPose ahead = pose, behind = pose;
      ahead.p_W[axis] += kStep;
      behind.p_W[axis] -= kStep;
      slope.col(axis) = (bench.at(ahead, from).force - bench.at(behind, from).force) / (2 * kStep);
    }
    CAPTURE(tangent, slope);
    CHECK((tangent - slope).norm() < 2e-3 * slope.norm());
  };
  const Vec3 slide(2e-4, 0, 3e-4);
  check(Bench(plane(1e-3), capsule()), lying(0.0015, 0.02), slide);
  check(Bench(plane(1e-3), capsule(0.3)), lying(0.0015, 0.02), slide);
  check(Bench(plane(1e-3), instrument()), Vec3(0.004, 0.0024, 0.0011), slide);
  check(Bench(ridge(-0.02, 1e-3), instrument()), Vec3(0.02, -0.0125, 0.0011), slide);
}

TEST_CASE("a capsule that lies on a face: tilting it through parallel moves nothing by much") {
  Bench bench(plane(1e-3), capsule());
  const ContactForce level = bench.at(lying(0.0015, 0));
  CHECK(level.converged);
  for (const double tilt : {-1e-6, -1e-9, 1e-9, 1e-6}) {
    const ContactForce tilted = bench.at(lying(0.0015, tilt));
    CHECK((tilted.force - level.force).norm() < 1e-3 * level.force.norm());
    CHECK((tilted.torque - level.torque).norm() < 1e-2 * level.torque.norm());
  }
  // Pressed evenly along its length, it pushes at its middle.
  CHECK(level.torque[2] == Approx(0.008 * level.force[1]).epsilon(0.15));
}

TEST_CASE("a capsule that turns in place rubs with its far end") {
  // A little below the plane with its far end alone; turned about the vertical through its tip.
  Bench bench(plane(1e-4), capsule(0.3));
  const ToolPose from = lying(0.0035, -0.12),
                 turned(from.p_W, Eigen::AngleAxisd(0.05, Vec3::UnitY()) * from.q_W);
  const ContactForce rubbed = bench.at(turned, from), rested = bench.at(turned, turned);
  REQUIRE(rubbed.contacts > 0);
  // By the right-hand rule the far end, at +x, goes towards -z; friction holds against that.
  CHECK(rubbed.force[2] > 0.25 * rubbed.force[1]);
  CHECK(std::abs(rested.force[2]) < 0.05 * rested.force[1]);
}

TEST_CASE("contacts without room leave the solve unconverged") {
  // A capsule lies with its ends on two triangles on springs. With room for one contact, the solve would
  // settle on half of the force.
  ContactPatch patch;
  patch.reserve(6, 2);
  for (const double x : {-0.008, 0.008}) {
    for (const Vec3& corner : {Vec3(-0.02, 0, -0.02), Vec3(0.02, 0, -0.02), Vec3(0, 0, 0.02)})
      patch.free.push_back(Vec3(x, 0, 0) + 0.25 * corner);
  }
  patch.triangles = {{0, 2, 1}, {3, 5, 4}};
  patch.compliance.setIdentity();
  patch.compliance *= 1e-3;
  const Tool tool = capsule();
  const ToolPose pose = lying(0.0015, 0);
  for (const int room : {1, 16}) {
    ContactSolver solver(6, room);
    Eigen::VectorXd u = Eigen::VectorXd::Zero(21);
    const ContactForce force = solver.solve(patch, tool, pose, u, {patch.free, pose.p_W, pose.q_W});
    INFO("room for " << room << ", " << force.contacts << " contacts");
    CHECK(force.force[1] > 0.1);
    CHECK(force.converged == (room > 1));
  }
}
