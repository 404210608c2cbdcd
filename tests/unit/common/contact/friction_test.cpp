// Contact with Coulomb friction against closed forms.
#include <numbers>
#include <set>
#include <vector>

#include "common/contact/contact_solver.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/dense_algebra.h"

using namespace palpate;

namespace {

constexpr double kRadius = 0.005, kMu = 0.3;
const Tool kTool{kRadius, kMu};

/// One large triangle in the plane y = 0: corners of compliance `c` in all directions, uncoupled.
ContactPatch single_triangle(double c, double tool_compliance) {
  ContactPatch patch;
  patch.reserve(3, 1);
  patch.free = {{-0.02, 0, -0.02}, {0.02, 0, -0.02}, {0, 0, 0.04}};
  patch.triangles = {{0, 2, 1}};
  patch.compliance.setIdentity();
  patch.compliance *= c;
  patch.tool_compliance = tool_compliance;
  return patch;
}

/// A grid of (2 n + 1)^2 nodes `h` apart on an incompressible half-space y < 0 of Young's modulus E, by the
/// solutions of Boussinesq and Cerruti (Johnson 1985, eq. 3.19 and 3.75 at nu = 1/2, where pressure and shear
/// do not mix); a node spreads its load over a disc of its cell's area.
ContactPatch half_space(int n, double h, double young) {
  ContactPatch patch;
  const int side = 2 * n + 1;
  patch.reserve(side * side, 2 * side * side);
  for (int i = -n; i <= n; ++i) {
    for (int j = -n; j <= n; ++j) patch.free.push_back(Vec3(i * h, 0, j * h));
  }
  for (int i = 0; i + 1 < side; ++i) {
    for (int j = 0; j + 1 < side; ++j) {
      const int a = side * i + j, b = a + side;
      patch.triangles.push_back({a, a + 1, b});
      patch.triangles.push_back({b, a + 1, b + 1});
    }
  }
  const double unit = 1.5 / (std::numbers::pi * young), own = 2 * std::sqrt(std::numbers::pi) / h;
  for (int i = 0; i < side * side; ++i) {
    for (int j = 0; j < side * side; ++j) {
      const Vec3 d = patch.free[i] - patch.free[j];
      const double r = d.norm();
      Mat3 block = 0.5 * own * unit * Vec3(1.5, 1, 1.5).asDiagonal().toDenseMatrix();
      if (i != j) block = 0.5 * unit / r * (Mat3::Identity() + d * d.transpose() / (r * r));
      patch.compliance.block<3, 3>(3 * i, 3 * j) = block;
    }
  }
  return patch;
}

/// A tool on a path: the caller of the solver as server and client are.
struct Path {
  explicit Path(ContactPatch on, const Tool& with = kTool)
      : patch(std::move(on)),
        tool(with),
        solver(patch.nodes(), static_cast<int>(patch.triangles.size()), with.friction > 0),
        u(Eigen::VectorXd::Zero(3 * (patch.nodes() + 1))),
        nodes(patch.free) {}

  /// What it would feel at p; nothing changes.
  ContactForce look(const Vec3& p) {
    Eigen::VectorXd there = u;
    return solver.solve(patch, tool, p, there, {nodes, tip});
  }
  ContactForce go(const Vec3& p) {
    if (!placed) tip = p;
    placed = true;
    const ContactForce force = solver.solve(patch, tool, p, u, {nodes, tip});
    for (int i = 0; i < patch.nodes(); ++i) nodes[i] = patch.free[i] + u.segment<3>(3 * i);
    tip = p + u.tail<3>();
    return force;
  }
  ContactForce go(const Vec3& from, const Vec3& to, int strides) {
    ContactForce force;
    for (int i = 1; i <= strides; ++i) force = go(from + (static_cast<double>(i) / strides) * (to - from));
    return force;
  }

  ContactPatch patch;
  Tool tool;
  ContactSolver solver;
  Eigen::VectorXd u;
  std::vector<Vec3> nodes;
  Vec3 tip = Vec3::Zero();
  bool placed = false;
};

Vec3 pressed(double depth) {
  return {0, kRadius - depth, 0};
}

double across(const Vec3& force) {
  return std::hypot(force[0], force[2]);
}

}  // namespace

TEST_CASE("friction on a rigid face with a soft tip is a spring with a slider, there and back") {
  // Closed form: the tip lags by up to mu F_n / k; below that it sticks and pulls with k times the way.
  constexpr double k = 800, depth = 0.002, normal = k * depth, lag = kMu * normal / k;
  Path path(single_triangle(0, 1 / k));
  CHECK(across(path.go(pressed(depth)).force) < 1e-9);
  double spring = 0, x = 0;
  for (const double to : {0.3 * lag, 0.9 * lag, 1.7 * lag, 5 * lag, 4.5 * lag, 2.9 * lag, -3 * lag, 0.0}) {
    const ContactForce force = path.go(pressed(depth) + to * Vec3::UnitX());
    spring = std::clamp(spring - k * (to - x), -kMu * normal, kMu * normal);
    x = to;
    CHECK(force.converged);
    CHECK(force.force[1] == Approx(normal).epsilon(1e-5));
    CHECK(force.force[0] == Approx(spring).epsilon(1e-5).margin(1e-7));
    CHECK(std::abs(force.force[2]) < 1e-9);
  }
}

TEST_CASE("friction: where a slide turns, the force turns with it") {
  constexpr double k = 800, depth = 0.002;
  Path path(single_triangle(0, 1 / k));
  path.go(pressed(depth));
  for (int i = 0; i < 16; ++i) {
    const double angle = 0.2 * i;
    const Vec3 way(std::cos(angle), 0, std::sin(angle));
    const Vec3 from = path.tip;  // the tip rests where it is until the lag is used up
    const ContactForce force = path.go(Vec3(from[0], kRadius - depth, from[2]) + 0.0015 * way);
    CHECK((force.force - kMu * force.force[1] * Vec3(-way[0], 1 / kMu, -way[2])).norm() < 1e-5);
    CHECK(path.tip[1] == Approx(kRadius).epsilon(1e-5));
  }
}

TEST_CASE("friction: a soft face is carried along until it slips: 3/c, then mu F") {
  const double c = 2e-3, depth = 0.002, normal = 3 * depth / c;
  Path path(single_triangle(c, 0));
  path.go(pressed(depth));
  const double lag = kMu * normal * c / 3;
  for (const double fraction : {0.2, 0.6, 0.95}) {
    const ContactForce force = path.go(pressed(depth) + fraction * lag * Vec3::UnitZ());
    CHECK(force.force[2] == Approx(-3 / c * fraction * lag).epsilon(1e-5));
  }
  const ContactForce slips = path.go(pressed(depth), pressed(depth) + 4 * lag * Vec3::UnitZ(), 40);
  // Off its middle the face tilts.
  const Vec3 up = (path.nodes[2] - path.nodes[0]).cross(path.nodes[1] - path.nodes[0]).normalized();
  const Vec3 friction = slips.force - slips.force.dot(up) * up;
  CHECK(friction.norm() == Approx(kMu * slips.force.dot(up)).epsilon(1e-6));
  CHECK(friction.normalized()[2] < -0.99);
  CHECK(path.nodes[0][2] + path.nodes[1][2] + path.nodes[2][2] > 0);  // the face went along
}

TEST_CASE("friction: a ball drags a face on springs to and fro: the loop of a spring with a slider") {
  // The face yields along itself alone, by c / 3, in series with the tip: k. The loop of force against way
  // has the area 4 mu F_n (x_max - mu F_n / k). The way is so short that each corner bears a third of the
  // force.
  constexpr double c = 5e-3, k_tip = 2000, depth = 2e-5, normal = k_tip * depth, most = kMu * normal,
                   k = 1 / (c / 3 + 1 / k_tip), farthest = 5 * most / k;
  const auto at = [](double x) -> Vec3 { return pressed(depth) + x * Vec3::UnitX(); };
  for (const int increments : {5, 20, 320}) {  // of each way; the slide starts at the end of one
    ContactPatch patch = single_triangle(c, 1 / k_tip);
    for (int i = 0; i < 3; ++i) patch.compliance(3 * i + 1, 3 * i + 1) = 0;
    Path path(std::move(patch));
    path.go(at(0));
    path.go(at(0), at(farthest), increments);
    double x = farthest, spring = most, last = -path.go(at(x)).force[0], area = 0;
    CHECK(last == Approx(most).epsilon(0.01));
    for (const double way : {-1.0, 1.0}) {
      for (int i = 1; i <= increments; ++i) {
        const double to = way * farthest * (2.0 * i / increments - 1);
        const ContactForce force = path.go(at(to));
        spring = std::clamp(spring + k * (to - x), -most, most);
        CAPTURE(increments, to / farthest, spring / most, force.force[0] / most);
        CHECK(force.converged);
        CHECK(force.force[1] == Approx(normal).epsilon(1e-4));
        CHECK(-force.force[0] == Approx(spring).margin(0.01 * most));
        area += 0.5 * (last - force.force[0]) * (to - x);
        last = -force.force[0];
        x = to;
      }
    }
    CHECK(area == Approx(4 * most * (farthest - most / k)).epsilon(0.01));
  }
}

TEST_CASE(
    "friction: pressing on a half-space, then sliding far: every contact at mu F_n, against the slide") {
  Path path(half_space(7, 0.0007, 3e4));
  const Vec3 way = Vec3(0.8, 0, -0.6);
  path.go(pressed(-1e-5), pressed(6e-4), 20);
  const Vec3 end = pressed(6e-4) + 0.0015 * way;
  const ContactForce force = path.go(pressed(6e-4), end, 60);
  CHECK(force.converged);
  CHECK(force.contacts > 10);
  // The surface is not level where it dents and heaves, so to the bend of it.
  CHECK(across(force.force) == Approx(kMu * force.force[1]).epsilon(0.15));
  CHECK(Vec3(force.force[0], 0, force.force[2]).normalized().dot(way) < -0.99);
}

TEST_CASE("friction: a small push sideways meets the stiffness of bonded nodes, by another dense solve") {
  // The points of contact follow the tool along their normals, the nodes that carry them across.
  Path path(half_space(6, 0.0008, 3e4));
  constexpr double kDepth = 1e-6;  // shallow: geometry hardly matters
  path.go(pressed(kDepth));
  const ContactForce before = path.go(pressed(kDepth));
  std::vector<Contact> contacts;
  contacts.reserve(path.patch.triangles.size());
  find_contacts_on_patch(path.nodes, path.patch.triangles, kTool, path.tip, 1e-12, contacts);
  REQUIRE(static_cast<int>(contacts.size()) == before.contacts);
  std::vector<Eigen::RowVectorXd> bonds;
  std::vector<Vec3> along;
  const auto bond = [&](const Vec3& axis) -> Eigen::RowVectorXd& {
    along.push_back(axis);
    return bonds.emplace_back(Eigen::RowVectorXd::Zero(3 * path.patch.nodes()));
  };
  std::set<int> nodes;
  for (const Contact& c : contacts) {
    Eigen::RowVectorXd& row = bond(Vec3::UnitY());
    for (int i = 0; i < c.size; ++i) row[3 * c.node[i] + 1] = c.weight[i];
    nodes.insert(c.node.begin(), c.node.begin() + c.size);
  }
  for (const int node : nodes) {
    for (const int axis : {0, 2}) bond(Vec3::Unit(axis))[3 * node + axis] = 1;
  }
  const auto n = static_cast<Eigen::Index>(bonds.size());
  Eigen::MatrixXd w(n, 3 * path.patch.nodes()), all(n, 3);
  for (Eigen::Index k = 0; k < n; ++k) {
    w.row(k) = bonds[static_cast<std::size_t>(k)];
    all.row(k) = along[static_cast<std::size_t>(k)].transpose();
  }
  const Eigen::MatrixXd delassus = w * path.patch.compliance * w.transpose();
  const Mat3 bonded = -all.transpose() * test::solve_least(delassus, all);
  constexpr double kStep = 1e-10;
  for (const Vec3& way : {Vec3(1, 0, 0), Vec3(0, 0, 1)}) {
    const Vec3 slope = (path.look(pressed(kDepth) + kStep * way).force - before.force) / kStep;
    CHECK((slope - bonded * way).norm() < 0.02 * (bonded * way).norm());
  }
}

TEST_CASE("friction: partial slip as of Cattaneo and Mindlin") {
  // F_t = mu F_n (1 - (1 - 2/3 k_0 x / (mu F_n))^(3/2)) for Hertz contact (Johnson 1985, section 7.2), k_0
  // the stiffness at first: exact for a smooth half-space, within a few per cent here.
  Path path(half_space(9, 0.0005, 3e4));
  path.go(pressed(-1e-5), pressed(4e-4), 10);
  const double normal = path.go(pressed(4e-4)).force[1], limit = kMu * normal;
  const double x_0 = 1e-8, begin = path.look(pressed(4e-4)).force[0];
  const double stiffness = -(path.look(pressed(4e-4) + x_0 * Vec3::UnitX()).force[0] - begin) / x_0;
  const double entire = 1.5 * limit / stiffness;  // where all slips
  double last = 0, last_slope = 1e9;
  for (int i = 1; i <= 12; ++i) {
    const double fraction = i / 10.0;
    const double pull = -path.go(pressed(4e-4) + fraction * entire * Vec3::UnitX()).force[0];
    const double mindlin = limit * (1 - std::pow(std::max(0.0, 1 - fraction), 1.5));
    CAPTURE(fraction, pull / limit, mindlin / limit);
    CHECK(pull == Approx(mindlin).margin(0.08 * limit));
    CHECK(pull > last);
    CHECK(pull - last < last_slope + 0.01 * limit);  // softer and softer
    last_slope = pull - last;
    last = pull;
  }
}

TEST_CASE("friction: a closed path takes energy, a path without slip gives it all back") {
  for (const double size : {2e-6, 4e-4}) {
    Path path(half_space(6, 0.0008, 3e4));
    path.go(pressed(-1e-5), pressed(4e-4), 10);
    double taken = 0, exchanged = 0;
    ContactForce last;
    Vec3 from = pressed(4e-4);
    constexpr int kTurn = 80;
    for (int i = 0; i <= 3 * kTurn; ++i) {
      const double angle = 2 * std::numbers::pi * i / kTurn;
      const Vec3 p =
          pressed(4e-4) + size * Vec3(std::sin(angle), 0.3 * std::sin(2 * angle), 1 - std::cos(angle));
      const ContactForce force = path.go(p);
      // The third turn: it begins and ends alike.
      if (i > 2 * kTurn) {
        const double work = -0.5 * (force.force + last.force).dot(p - from);
        taken += work;
        exchanged += std::abs(work);
      }
      last = force;
      from = p;
    }
    CAPTURE(size, taken, exchanged);
    if (size < 1e-5) {
      CHECK(std::abs(taken) < 0.01 * exchanged);
    } else {
      CHECK(taken > 0.3 * exchanged);
    }
  }
}

TEST_CASE("friction: strides half as long lead to one path, twice as near") {
  const auto end = [](int strides) {
    Path path(half_space(6, 0.0008, 3e4));
    path.go(pressed(0), pressed(4e-4), strides);
    Vec3 force;
    for (int i = 1; i <= strides; ++i) {
      const double angle = 2.0 * i / strides;
      force = path.go(pressed(4e-4) + 2e-4 * Vec3(std::sin(angle), 0, 1 - std::cos(angle))).force;
    }
    return force;
  };
  const Vec3 a = end(16), b = end(32), c = end(64), d = end(128);
  CAPTURE((a - b).norm(), (b - c).norm(), (c - d).norm(), d.norm());
  CHECK((b - c).norm() < 0.75 * (a - b).norm());
  CHECK((c - d).norm() < 0.75 * (b - c).norm());
  CHECK((c - d).norm() < 0.01 * d.norm());
}

TEST_CASE("friction 0 is contact without friction, bit by bit") {
  Path without(half_space(5, 0.0008, 3e4), {kRadius, 0});
  ContactSolver both(without.patch.nodes(), static_cast<int>(without.patch.triangles.size()), true);
  Eigen::VectorXd u = without.u;
  for (int i = 0; i < 20; ++i) {
    const Vec3 p = pressed(2e-5 * i) + 3e-5 * i * Vec3::UnitX();
    const ContactForce expected = without.go(p), force = both.solve(without.patch, without.tool, p, u);
    CHECK(force.force == expected.force);
    CHECK(force.iterations == expected.iterations);
    CHECK(u == without.u);
    CHECK(both.tangent(without.patch) == without.solver.tangent(without.patch));
  }
}

TEST_CASE("friction: a little friction is near to none") {
  Path with(half_space(5, 0.0008, 3e4), {kRadius, 1e-6}), without(half_space(5, 0.0008, 3e4), {kRadius, 0});
  for (int i = 0; i < 20; ++i) {
    const Vec3 p = pressed(2e-5 * i) + 3e-5 * i * Vec3::UnitX();
    const Vec3 expected = without.go(p).force;
    CHECK((with.go(p).force - expected).norm() <= 1e-5 * expected.norm());
  }
}

TEST_CASE("friction: the tangent agrees with finite differences, in stick, in partial and in full slip") {
  for (const double slide : {0.0, 3e-5, 1e-3}) {
    Path path(half_space(6, 0.0008, 3e4));
    path.go(pressed(-1e-5), pressed(4e-4), 20);
    // What slipped last and rests would stick one way and slip the other: a step back, and all of it sticks.
    const double depth = slide == 0 ? 3.98e-4 : 4e-4;
    const Vec3 way(0.8, 0, 0.6), p = pressed(depth) + slide * way;
    path.go(pressed(4e-4), p, 20);
    // From there one more stride, as long as those before.
    const Vec3 there = p + (slide / 20) * way;
    path.look(there);
    const Mat3 tangent = path.solver.tangent(path.patch);
    const double step = slide == 0 ? 1e-10 : 1e-9;
    Mat3 slope;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 d = step * Vec3::Unit(axis);
      slope.col(axis) = (path.look(there + d).force - path.look(there - d).force) / (2 * step);
    }
    CAPTURE(slide, tangent, slope);
    CHECK((tangent - slope).norm() < 2e-3 * slope.norm());
  }
}

TEST_CASE("friction: what slipped last and rests follows as if it stuck, the same both ways") {
  Path path(half_space(6, 0.0008, 3e4));
  path.go(pressed(-1e-5), pressed(4e-4), 20);
  const Vec3 at_rest = path.look(pressed(4e-4)).force;
  const Mat3 tangent = path.solver.tangent(path.patch);
  CHECK((tangent - tangent.transpose()).norm() < 1e-6 * tangent.norm());
  // Whichever way it goes, some of it slips: stick is the stiffer.
  for (const Vec3& way : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 0, 1)}) {
    const double slope = way.dot(path.look(pressed(4e-4) + 1e-9 * way).force - at_rest) / 1e-9;
    CHECK(way.dot(tangent * way) < slope);
    CHECK(way.dot(tangent * way) == Approx(slope).epsilon(0.05));
  }
}

TEST_CASE("friction: a contact that was lost is forgotten") {
  Path path(half_space(5, 0.0008, 3e4)), fresh(half_space(5, 0.0008, 3e4));
  path.go(pressed(4e-4));
  path.go(pressed(4e-4), pressed(4e-4) + 3e-4 * Vec3::UnitX(), 10);
  const Vec3 above = pressed(-2e-4) - 3e-4 * Vec3::UnitZ();
  CHECK(path.go(above).force == Vec3::Zero());
  CHECK(path.u.isZero(0));
  fresh.go(above);
  for (const double depth : {1e-4, 2e-4, 4e-4})
    CHECK(path.go(pressed(depth)).force == fresh.go(pressed(depth)).force);
}

TEST_CASE("friction: a solve and its tangent do not allocate") {
  Path path(half_space(5, 0.0008, 3e4));
  path.go(pressed(4e-4));
  const IncrementStart start{path.nodes, path.tip};
  std::size_t allocations = 1;
  {
    const test::AllocationGuard guard;
    path.solver.solve(path.patch, path.tool, pressed(4e-4) + 1e-4 * Vec3::UnitX(), path.u, start);
    path.solver.tangent(path.patch);
    allocations = guard.count();
  }
  CHECK(allocations == 0);
}
