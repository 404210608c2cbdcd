// The residual of a step, against motions that are known: a body that flies, and one that falls.
#include "sim_server/solvers/equations_of_motion.h"

#include "sim_server/mesh/shapes.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

Solid body(ElasticLaw law = ElasticLaw::kNeoHookean, std::vector<Relaxation> relaxations = {}) {
  return Solid(grid_block(lines(0, 0.05, 2), lines(0, 0.05, 2), lines(0, 0.05, 2)),
               {8e3, 0.4, 1000, law, ElementKind::kLinear, {}, std::move(relaxations)});
}
std::vector<HeldAxes> held_nowhere(const Solid& solid) {
  return std::vector<HeldAxes>(solid.rest().size(), 0);
}
std::vector<Vec3> shaken(const Solid& solid, double size) {
  Random random(3);
  std::vector<Vec3> x = solid.rest();
  for (Vec3& p : x) p += random.vector(size);
  return x;
}

}  // namespace

TEST_CASE("equations of motion: a body that flies is in balance where its velocity leads") {
  const Solid solid = body();
  EquationsOfMotion motion(solid, held_nowhere(solid), {.rayleigh_stiffness = 0.01, .second_order = true});
  motion.set_negligible_force(1e-6);
  const Vec3 v(0.3, -0.1, 0.2);
  motion.restart(solid.rest(), std::vector<Vec3>(solid.rest().size(), v));
  const std::vector<Vec3> none(solid.rest().size(), Vec3::Zero());
  for (int step = 0; step < 5; ++step) {
    motion.start_step(0.01);
    CHECK(motion.residual(none).relative < 1e-3);
    motion.end_step(false);
  }
  CHECK((motion.position()[7] - solid.rest()[7] - 0.05 * v).norm() < 1e-12);
  double mass = 0;
  for (const double m : solid.masses()) mass += m;
  CHECK(motion.kinetic_energy() == Approx(0.5 * mass * v.squaredNorm()));
}

TEST_CASE("equations of motion: a residual is the load less inertia, damping and internal forces") {
  const Solid solid = body();
  const double alpha = 3, beta = 0.02, h = 0.01, c = 1 / h;
  EquationsOfMotion motion(solid, held_nowhere(solid), {.rayleigh_mass = alpha, .rayleigh_stiffness = beta});
  motion.set_negligible_force(1e-9);
  const std::vector<Vec3> from = shaken(solid, 1e-3), to = shaken(solid, 2e-3);
  Random random(4);
  std::vector<Vec3> v(from.size()), load(from.size()), f(from.size()), f_from(from.size());
  for (std::size_t i = 0; i < v.size(); ++i) {
    v[i] = random.vector(0.2);
    load[i] = random.vector(0.5);
  }
  motion.restart(from, v);
  motion.start_step(h);
  for (std::size_t i = 0; i < v.size(); ++i)
    CHECK((motion.position()[i] - from[i] - h * v[i]).norm() < 1e-15);
  motion.move_to(to);
  const Residual found = motion.residual(load);
  solid.forces(to, f);
  solid.forces(from, f_from);
  const std::vector<double> mass = solid.masses();
  double scale = 1e-18;
  Eigen::VectorXd residual(found.force.size());
  std::vector<Vec3> resistance(from.size());
  motion.resistance(resistance);
  for (std::size_t i = 0; i < v.size(); ++i) {
    const Vec3 speed = c * (to[i] - from[i]), inertia = mass[i] * (c * (speed - v[i]) + alpha * speed),
               all = f[i] + beta * c * (f[i] - f_from[i]) + inertia;
    residual.segment<3>(motion.dofs().first[i]) = load[i] - all;
    scale += f[i].squaredNorm() + load[i].squaredNorm() + inertia.squaredNorm();
    CHECK((resistance[i] - all).norm() < 1e-9 * all.norm());
  }
  CHECK((found.force - residual).norm() < 1e-9 * residual.norm());
  CHECK(found.force_scale == Approx(std::sqrt(scale)));
  CHECK(found.relative == Approx(residual.norm() / std::sqrt(scale)));
  CHECK(motion.last_force_scale() == found.force_scale);
  CHECK(motion.last_external()[3] == load[3]);
  // Back at the start, free nodes alone, with the forces that are known there.
  const Eigen::VectorXd increment = motion.move_to_start();
  CHECK((motion.position()[5] - from[5]).norm() == 0);
  CHECK((increment.segment<3>(motion.dofs().first[5]) - h * v[5]).norm() < 1e-15);
  motion.move_by(increment);
  CHECK((motion.position()[5] - from[5] - h * v[5]).norm() < 1e-15);
}

TEST_CASE("equations of motion: internal forces of the start of a step serve only while they are of it") {
  const Solid solid = body();
  std::vector<HeldAxes> held = held_nowhere(solid);
  held[0] = kAllAxes;
  const std::vector<Vec3> none(held.size(), Vec3::Zero());
  EquationsOfMotion motion(solid, held, {}), again(solid, held, {});
  for (EquationsOfMotion* each : {&motion, &again}) {
    each->set_negligible_force(1e-9);
    each->restart(shaken(solid, 1e-3), none);
    each->start_step(0.01);
    each->residual(none);
    each->end_step(true);
    each->start_step(0.01);
  }
  // One with its held node elsewhere: the forces at the start of the step are others.
  motion.mutable_position()[0] += Vec3(1e-3, 0, 0);
  motion.move_to_start();
  again.move_to_start();
  std::vector<Vec3> moved(motion.position().begin(), motion.position().end());
  const Residual found = motion.residual(none), unmoved = again.residual(none);
  CHECK((found.force - unmoved.force).norm() > 1e-3 * unmoved.force.norm());
  motion.move_to(moved);  // evaluated anew
  CHECK(motion.residual(none).force == found.force);
}
