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

TEST_CASE("contact finder: an axis that lies on more triangles than there is room for is not without any") {
  const TetMesh mesh = soft_block(Vec3(0.1, 0.02, 0.03), {20, 4, 6});
  const Surface surface = boundary_surface(mesh);
  std::vector<Vec3> rest;
  for (const int v : surface.vertices) rest.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
  const double radius = 0.001, length = 0.09;
  ContactFinder finder(rest, surface.triangles, surface.triangles, 2 * radius, length, {},
                       ContactFinder::kUsualRoom);
  ContactPatch patch;
  patch.reserve(finder.max_nodes(), finder.max_triangles());
  for (const double height : {0.0, 5e-4, 1e-3}) {
    for (int i = 0; i <= 20; ++i) {  // across two rows of squares, from line to line
      const Vec3 p(-0.045, height, -0.005 + 5e-4 * i), q = p + Vec3(length, 0, 0);
      finder.gather(rest, rest, p, q, 1.2 * radius, patch);
      CAPTURE(height, i);
      CHECK(patch.triangles.size() >= 30);
      double nearest = 1;
      for (const Triangle& t : patch.triangles) {
        const auto at = [&](int node) { return rest[static_cast<std::size_t>(finder.vertices()[node])]; };
        for (const int node : t) nearest = std::min(nearest, std::abs(at(node).z() - p.z()));
      }
      CHECK(nearest < 0.0051);
    }
  }
}
