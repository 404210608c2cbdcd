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
#include "tests/support/one_free_vertex.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

using Complex = std::complex<double>;

constexpr double kTau = 2 * std::numbers::pi, kAmplitude = 1e-4, kPeriod = 1.0 / 30;  // m, s

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

  /// Force per displacement of the steady oscillation, by least squares over the last second of two.
  Complex measured(double w) const {
    Simulation simulation(scene, mesh);
    const int instants = simulation.instants();
    const auto place = [&](double t) { return Vec3(kAmplitude * std::sin(w * t) * direction); };
    std::vector<ToolInput> input(1);
    std::vector<PathPoint> path(static_cast<std::size_t>(instants - 1));
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (int step = 1; step <= 60; ++step) {
      const double t = step * kPeriod;
      for (int k = 1; k < instants; ++k)
        path[static_cast<std::size_t>(k) - 1] = {place(t - kPeriod + k * kPeriod / instants)};
      input[0].pose = place(t);
      input[0].path = path;
      const double force = -simulation.step(input, kPeriod).front().force.dot(direction);
      if (step <= 30) continue;
      const Eigen::Vector2d parts(std::sin(w * t), std::cos(w * t));
      normal += parts * parts.transpose();
      right += force * parts;
    }
    const Eigen::Vector2d fit = normal.inverse() * right / kAmplitude;
    return {fit[0], fit[1]};
  }
};

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
