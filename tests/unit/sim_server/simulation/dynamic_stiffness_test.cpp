// A grasped vertex that is shaken, at 30 Hz, against its dynamic stiffness K - w^2 m + i w C.
#include <Eigen/LU>
#include <complex>
#include <numbers>
#include <optional>
#include <tuple>

#include "sim_server/simulation/simulation.h"
#include "sim_server/tissue/contact_instants.h"
#include "sim_server/tissue/rayleigh_damping.h"
#include "tests/support/catch.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/one_free_vertex.h"
#include "tests/support/soft_block.h"
#include "tests/support/stiffness.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

using Complex = std::complex<double>;

constexpr double kTau = 2 * std::numbers::pi, kAmplitude = 1e-4, kPeriod = 1.0 / 30;  // m, s

/// Force against displacement along `direction` of a tool that swings at `w` (rad/s) about `centre`, in steps
/// of 1/30 s: N/m, by least squares over the last second of two.
Complex measured_stiffness(const Scene& scene, const TetMesh& mesh, const Vec3& centre, const Vec3& direction,
                           double amplitude, double w) {
  Simulation simulation(scene, mesh);
  const int instants = simulation.instants();
  const auto place = [&](double t) { return Vec3(centre + amplitude * std::sin(w * t) * direction); };
  std::vector<ToolInput> input(1);
  std::vector<PathPoint> path(static_cast<std::size_t>(instants - 1));
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (int step = 1; step <= 60; ++step) {
    const double t = step * kPeriod;
    for (int k = 1; k < instants; ++k)
      path[static_cast<std::size_t>(k) - 1] = {place(t - kPeriod + k * kPeriod / instants)};
    input[0].pose = place(t);
    input[0].path = path;
    const double force = -simulation.step(input, kPeriod).front().force.dot(direction);
    if (step <= 30) continue;
    const Eigen::Vector3d parts(std::sin(w * t), std::cos(w * t), 1);
    normal += parts * parts.transpose();
    right += force * parts;
  }
  const Eigen::Vector3d fit = normal.inverse() * right / amplitude;
  return {fit[0], fit[1]};
}

/// That vertex held by a tool that moves it along its softest direction.
struct HeldVertex : OneFreeVertex {
  double damping;  // by stiffness, of 1 / frequency

  /// `instants`: of one sub-step each, much shorter than 1 / frequency; none: as the model chooses.
  explicit HeldVertex(double damped = 0.3, std::optional<int> instants = 60) : damping(damped) {
    scene.rate_hz = 1 / kPeriod;
    scene.tools[0].grasp_place = Vec3::Zero();
    scene.deformation.model = "tensor_mass";
    scene.deformation.of<RayleighDamping>().mass = 0.2 * frequency;
    scene.deformation.of<RayleighDamping>().stiffness = damping / frequency;
    scene.deformation.of<ContactInstants>().instants = instants;
  }

  Complex exact(double w) const {
    return stiffness - w * w * mass +
           Complex(0, w) * (0.2 * frequency * mass + damping / frequency * stiffness);
  }

  Complex measured(double w) const {
    return measured_stiffness(scene, mesh, Vec3::Zero(), direction, kAmplitude, w);
  }
};

/// A block of 40 x 20 x 40 mm and 100 kPa with cells of 10 mm, damped so that sub-steps are short.
struct StiffBlock {
  TetMesh mesh = soft_block(Vec3(0.04, 0.02, 0.04), {4, 2, 4});
  Scene scene = deep_block_scene("tensor_mass");
  explicit StiffBlock(double damped) {  // s, by stiffness
    scene.deformation.of<RayleighDamping>().stiffness = damped;
    scene.rate_hz = 1 / kPeriod;
    scene.material->young_modulus = 1e5;
    scene.material->density = 1000;
    scene.deformation.of<ContactInstants>().instants.reset();
  }
  /// Dynamic stiffness of the vertex at the origin along y while it is held along x and z, of the entire
  /// body, N/m: by elimination of (1 + i w b) K - w^2 M + i w a M, assembled as a `Solid`.
  Complex exact(double w) const {
    const Solid solid(mesh, *scene.material);
    std::vector<int> held;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      if (mesh.vertices[v].y() < -0.0199) held.push_back(static_cast<int>(v));
    }
    const FreeDofs dofs(solid.nodes(), held);
    const std::vector<double> masses = solid.masses();
    const auto& damping = scene.deformation.of<RayleighDamping>();
    Eigen::MatrixXcd dynamic = Complex(1, w * damping.stiffness) * dense_stiffness(solid, dofs);
    Eigen::Index loaded = -1;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      const int first = dofs.first[v];
      if (first < 0) continue;
      dynamic.diagonal().segment<3>(first).array() += Complex(-w * w, w * damping.mass) * masses[v];
      if (mesh.vertices[v].norm() < 1e-9) loaded = first;
    }
    Eigen::MatrixXcd units = Eigen::MatrixXcd::Zero(dynamic.rows(), 3);
    units.middleRows<3>(loaded).setIdentity();
    const Eigen::Matrix3cd compliance = solve_any(dynamic, units).middleRows<3>(loaded);
    return compliance.inverse()(1, 1);
  }
};

double degrees(Complex z) {
  return std::arg(z) * 360 / kTau;
}

}  // namespace

TEST_CASE("dynamic stiffness: a grasped vertex answers in size and phase as its mass, damping and springs") {
  const HeldVertex vertex;
  for (const double hertz : {2.0, 20.0 / 3, 8.0, 13.0}) {
    CAPTURE(hertz);
    const Complex error = vertex.measured(kTau * hertz) / vertex.exact(kTau * hertz);
    CHECK(std::abs(error) == Approx(1).margin(0.01));
    CHECK(std::arg(error) * 360 / kTau == Approx(0).margin(0.3));
  }
}

TEST_CASE("dynamic stiffness: a step of hundreds of sub-steps is felt in size and phase, too") {
  // Damping makes sub-steps short: one instant for each, and at last one for every few.
  for (const auto& [damping, least, most] : {std::tuple(20.0, 150, 500), std::tuple(100.0, 250, 500)}) {
    const HeldVertex vertex(damping, std::nullopt);
    const int instants = Simulation(vertex.scene, vertex.mesh).instants();
    CAPTURE(damping, instants);
    CHECK(instants >= least);
    CHECK(instants <= most);
    for (const double hertz : {2.0, 20.0 / 3, 8.0, 13.0}) {
      CAPTURE(hertz);
      const Complex error = vertex.measured(kTau * hertz) / vertex.exact(kTau * hertz);
      CHECK(std::abs(error) == Approx(1).margin(0.01));
      CHECK(std::arg(error) * 360 / kTau == Approx(0).margin(0.5));
    }
  }
}

TEST_CASE(
    "dynamic stiffness: a stiff block of many sub-steps lags its tool by what damps it, and takes work") {
  for (const auto& [damped, hertz] : {std::pair(3e-4, 8.0), std::pair(1e-3, 8.0), std::pair(1e-3, 14.0)}) {
    StiffBlock block(damped);
    const double w = kTau * hertz;
    const auto measured = [&](const Vec3& centre) {
      return measured_stiffness(block.scene, block.mesh, centre, Vec3::UnitY(), kAmplitude, w);
    };
    const Complex exact = block.exact(w), pressed = measured(Vec3(0, 0.002, 0));
    block.scene.tools[0].grasp_place = Vec3::Zero();
    const Complex grasped = measured(Vec3::Zero());
    CAPTURE(hertz, std::abs(exact), degrees(exact), degrees(pressed));
    CHECK(Simulation(block.scene, block.mesh).instants() > 100);
    CHECK(std::abs(grasped / exact) == Approx(1).margin(0.01));
    CHECK(degrees(grasped / exact) == Approx(0).margin(0.3));
    CHECK(degrees(pressed) == Approx(degrees(exact)).margin(1));
  }
}

TEST_CASE("dynamic stiffness: a tool that jumps is not taken to go on so") {
  const HeldVertex vertex;
  Simulation simulation(vertex.scene, vertex.mesh);
  std::vector<ToolInput> input(1);
  std::vector<PathPoint> path(static_cast<std::size_t>(simulation.instants() - 1), {ToolPose(Vec3::Zero())});
  input[0].path = path;
  const auto step = [&](const Vec3& p_W) {
    input[0].pose = p_W;
    return simulation.step(input, kPeriod).front().force;
  };
  CHECK(step(Vec3::Zero()).norm() == Approx(0).margin(1e-12));
  // In the last instant alone, by more than half the tool's radius.
  const Vec3 jump = 0.004 * vertex.direction;
  const double there = vertex.mass * jump.norm() / std::pow(kPeriod / simulation.instants(), 2);
  CHECK(step(jump).norm() < 1.5 * there);  // as of one who jumped, not of one who goes on by as much
}
