#include "sim_server/contact/contact_finder.h"

#include <cmath>
#include <numbers>

#include "sim_server/mesh/surface.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"
#include "tests/support/soft_block.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

/// The winding number by solid angles (Van Oosterom and Strackee 1983, IEEE Trans. Biomed. Engng 30:125).
double winding_number(std::span<const Triangle> triangles, std::span<const Vec3> x, const Vec3& p) {
  double angle = 0;
  for (const Triangle& t : triangles) {
    const Vec3 a = x[t[0]] - p, b = x[t[1]] - p, c = x[t[2]] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4 * std::numbers::pi);
}

}  // namespace

TEST_CASE("contact finder: inside is where the surface winds around, at rest, bent, and through itself") {
  const TetMesh mesh = soft_block(Vec3(0.06, 0.02, 0.04), {12, 4, 8});
  const Surface surface = boundary_surface(mesh);
  std::vector<Vec3> rest;
  for (const int v : surface.vertices) rest.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
  const ContactFinder finder(rest, surface.triangles, surface.triangles, 0.005, 0, {},
                             ContactFinder::kUsualRoom);
  Random random(7);
  for (const double bend : {0.0, 20.0, 90.0}) {  // 1/m; the last rolls it up into itself
    std::vector<Vec3> bent;
    for (const Vec3& x : rest) {
      const double angle = bend * x.x(), radius = bend > 0 ? 1 / bend + x.y() : 0;
      bent.push_back(bend > 0 ? Vec3(radius * std::sin(angle), radius * std::cos(angle) - 1 / bend, x.z())
                              : x);
    }
    int in = 0;
    for (int i = 0; i < 8000; ++i) {
      Vec3 p = random.vector(0.04);
      if (i % 2 == 0)
        p = 0.005 * (p / 0.005).array().round() + Vec3(0.0012, 0, 0).array();  // on lines of the grid
      if ((finder.nearest(bent, p) - p).norm() < 1e-6) continue;               // on the surface
      const double winding = winding_number(surface.triangles, bent, p);
      CAPTURE(bend, p.transpose(), winding);
      REQUIRE(finder.inside(bent, p) == (winding > 0.5));
      in += winding > 0.5 ? 1 : 0;
    }
    CHECK(in > 50);
  }
}
