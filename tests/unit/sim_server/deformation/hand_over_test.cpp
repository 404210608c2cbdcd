#include "sim_server/deformation/hand_over.h"

#include <algorithm>
#include <numeric>

#include "sim_server/deformation/slow_modes.h"
#include "sim_server/simulation/simulation.h"
#include "tests/support/catch.h"
#include "tests/support/soft_block.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

/// A block of which what is within 6 mm of its middle plane is in motion, and one of which more to the right.
struct TwoBodies {
  TwoBodies()
      : mesh(soft_block(Vec3(0.06, 0.02, 0.04), {12, 4, 8})),
        surface(boundary_surface(mesh)),
        scene(soft_block_scene(0.02, "hybrid", ElasticLaw::kLinear, 0.003)),
        fixed(fixed_vertices(scene, mesh)),
        reachable(surface.vertices.size()) {
    std::iota(reachable.begin(), reachable.end(), 0);
    const ModelInputs inputs{scene, mesh, surface, fixed, reachable, kSilent};
    const std::vector<double> masses(mesh.tetrahedra.size(), 1);
    const CondensedRest::Modes modes{.most = ClientModes::by_default(), .keeps_shapes = true};
    const std::vector<char> less = from_to(-0.006, 0.006), more = from_to(-0.006, 0.016);
    before.emplace(inputs, masses, &less, modes);
    after.emplace(inputs, masses, &more, modes);
  }

  std::vector<char> from_to(double left, double right) const {
    std::vector<char> moves;
    for (const Vec3& x : mesh.vertices) moves.push_back(x.x() >= left && x.x() <= right ? 1 : 0);
    return moves;
  }

  /// How far each surface vertex of a body is displaced where its motion stands at `u`, and its rest as it
  /// swings, but for loads.
  std::vector<Vec3> shape_of(CuttableBody& body, const std::vector<double>& u) const {
    body.rest->stand_at(u);
    std::vector<Vec3> shape;
    for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
      shape.emplace_back(Vec3::Zero());
      if (body.first[v] >= 0) shape.back() = Eigen::Map<const Vec3>(u.data() + body.first[v]);
      if (body.rest->has(static_cast<int>(v))) shape.back() = body.rest->carried(static_cast<int>(v));
    }
    return shape;
  }

  TetMesh mesh;
  Surface surface;
  Scene scene;
  std::vector<int> fixed, reachable;
  std::optional<CuttableBody> before, after;
};

double largest(const std::vector<Vec3>& all) {
  double most = 0;
  for (const Vec3& x : all) most = std::max(most, x.norm());
  return most;
}

double apart(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double most = 0;
  for (std::size_t v = 0; v < a.size(); ++v) most = std::max(most, (a[v] - b[v]).norm());
  return most;
}

}  // namespace

TEST_CASE("hand-over: where the rest is at rest, the body that takes over is where the one before was") {
  TwoBodies bodies;
  CuttableBody &before = *bodies.before, &after = *bodies.after;
  for (std::size_t k = 0; k < before.motion.state.u.size(); ++k) {
    before.motion.state.u[k] = 1e-4 * static_cast<double>((7 * k) % 11);
    before.motion.state.v[k] = 1e-2 * static_cast<double>((5 * k) % 13);
  }
  before.rest->stand_still(before.motion.state.v, {});
  const std::vector<Eigen::VectorXd> rates = before.rest->swing().p;
  const std::vector<Vec3> speeds = bodies.shape_of(before, before.motion.state.v);
  before.rest->stand_still(before.motion.state.u, {});
  before.rest->set_swing({before.rest->swing().p, rates});
  const std::vector<Vec3> places = bodies.shape_of(before, before.motion.state.u);
  HandOver hand_over(after, before, before.tensors.places());
  CHECK(hand_over.joining() > 30);
  hand_over(before, {});
  CHECK(largest(places) > 1e-4);
  CHECK(apart(bodies.shape_of(after, after.motion.state.u), places) < 1e-9 * largest(places));
  const CondensedRest::Swing swing = after.rest->swing();
  after.rest->set_swing({swing.v, swing.p});
  CHECK(apart(bodies.shape_of(after, after.motion.state.v), speeds) < 1e-9 * largest(speeds));
}

#ifdef PALPATE_WITH_SPECTRA
TEST_CASE("hand-over: a rest that swings in its slowest mode swings on") {
  TwoBodies bodies;
  CuttableBody &before = *bodies.before, &after = *bodies.after;
  CondensedRest::Swing swing = before.rest->swing();
  for (std::size_t part = 0; part < swing.p.size(); ++part) {
    REQUIRE(swing.p[part].size() > 10);
    swing.p[part][0] = 1e-4;
    swing.v[part][1] = 1e-2;
  }
  before.rest->set_swing(swing);
  const std::vector<Vec3> places = bodies.shape_of(before, before.motion.state.u);
  before.rest->set_swing({swing.v, swing.p});
  const std::vector<Vec3> speeds = bodies.shape_of(before, before.motion.state.v);
  before.rest->set_swing(swing);
  HandOver hand_over(after, before, before.tensors.places());
  hand_over(before, {});
  const CondensedRest::Swing own = after.rest->swing();
  CHECK(apart(bodies.shape_of(after, after.motion.state.u), places) < 0.03 * largest(places));
  after.rest->set_swing({own.v, own.p});
  CHECK(apart(bodies.shape_of(after, after.motion.state.v), speeds) < 0.05 * largest(speeds));
}
#endif
