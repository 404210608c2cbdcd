#include "common/contact/contact_solver.h"

#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"

using namespace palpate;

namespace {

constexpr double kRadius = 0.005;

/// One triangle in the plane y = 0 whose corners are springs of compliance `c` in all directions, uncoupled.
ContactPatch single_triangle(double c, double tool_compliance = 0) {
  ContactPatch patch;
  patch.reserve(3, 1);
  patch.free = {{-0.01, 0, -0.01}, {0.01, 0, -0.01}, {0, 0, 0.02}};
  patch.triangles = {{0, 2, 1}};
  patch.compliance.setIdentity();
  patch.compliance *= c;
  patch.tool_compliance = tool_compliance;
  return patch;
}

}  // namespace

TEST_CASE("out of reach: no force, nothing moves") {
  ContactPatch patch = single_triangle(1e-3);
  ContactSolver solver(3, 1);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(12);
  const ContactForce contact = solver.solve(patch, {kRadius}, Vec3(0, kRadius + 1e-6, 0), u);
  CHECK(contact.force == Vec3::Zero());
  CHECK(contact.contacts == 0);
  CHECK(u.isZero(0));
  CHECK(solver.tangent(patch).isZero(0));
}

TEST_CASE("pressing the centroid of a face sinks it evenly: F = depth / (c / 3)") {
  // Each corner carries a third, so the compliance at the centroid is 3 (1/3)^2 c.
  const double c = 2e-3, depth = 0.002;
  ContactPatch patch = single_triangle(c);
  ContactSolver solver(3, 1);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(12);
  const ContactForce contact = solver.solve(patch, {kRadius}, Vec3(0, kRadius - depth, 0), u);
  CHECK(contact.converged);
  CHECK(contact.contacts == 1);
  CHECK(contact.force[1] ==
        Approx(3 * depth / c).epsilon(1e-5));  // 1e-5: the solver's own contact compliance
  CHECK(contact.force.head<1>().norm() < 1e-9);
  CHECK(u[1] == Approx(-depth).epsilon(1e-5));
  const auto forces = solver.node_forces();
  CHECK(forces[1] + forces[4] + forces[7] == Approx(-contact.force[1]));
}

TEST_CASE("a rigid face with a soft tip is the penetration force k x depth") {
  ContactPatch patch = single_triangle(0, 1.0 / 800);
  ContactSolver solver(3, 1);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(12);
  const ContactForce contact = solver.solve(patch, {kRadius}, Vec3(0.001, kRadius - 0.002, 0.001), u);
  CHECK(contact.force[1] == Approx(1.6).epsilon(1e-5));
  CHECK(solver.tangent(patch)(1, 1) == Approx(-800).epsilon(1e-5));
}

TEST_CASE("the tangent of a rigid vertex is that of a spring to a ball around it") {
  // The tip rests on the sphere of radius R around the vertex: F = k (R - r) n with r the distance of the
  // tool centre, so dF/dp = -k n n^T + k (R - r) / r (I - n n^T): closed form.
  ContactPatch patch = single_triangle(0, 1.0 / 500);
  const Vec3 vertex = patch.free[2], n = Vec3(0, 0.6, 0.8);
  const double r = 0.004;
  ContactSolver solver(3, 1);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(12);
  const ContactForce contact = solver.solve(patch, {kRadius}, vertex + r * n, u);
  CHECK((contact.force - 500 * (kRadius - r) * n).norm() < 1e-5);
  const Mat3 expected =
      -500 * n * n.transpose() + 500 * (kRadius - r) / r * (Mat3::Identity() - n * n.transpose());
  CHECK((solver.tangent(patch) - expected).norm() < 1e-5 * expected.norm());
}

TEST_CASE("a solve and its tangent do not allocate") {
  ContactPatch patch = single_triangle(1e-3, 1e-4);
  ContactSolver solver(3, 1);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(12);
  std::size_t allocations = 1;
  {
    const test::AllocationGuard guard;
    solver.solve(patch, {kRadius}, Vec3(0.002, kRadius - 0.003, 0.001), u);
    solver.tangent(patch);
    allocations = guard.count();
  }
  CHECK(allocations == 0);
}
