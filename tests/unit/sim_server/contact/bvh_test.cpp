// What the hierarchy finds is what a pass over all triangles finds, bit by bit.
#include "sim_server/contact/bvh.h"

#include <algorithm>

#include "common/contact/simplex_distance.h"
#include "sim_server/contact/contact_finder.h"
#include "sim_server/mesh/gmsh_io.h"
#include "sim_server/mesh/shapes.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/random.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

/// A surface, at rest and deformed by some bumps and a turn.
struct Skin {
  explicit Skin(const TetMesh& mesh) : surface(boundary_surface(mesh)) {
    for (const int vertex : surface.vertices) rest.push_back(mesh.vertices[vertex]);
    now = rest;
    for (const Vec3& x : rest) box.extend(x);
  }
  void deform(test::Random& random) {
    const Vec3 push = random.vector(0.02);
    const Vec3& at = rest[random.bits() % rest.size()];
    const Eigen::AngleAxisd turn(random.between(-0.5, 0.5), random.vector(1).normalized());
    for (std::size_t i = 0; i < rest.size(); ++i)
      now[i] = turn * (rest[i] + push * std::exp(-(rest[i] - at).norm() / 0.02));
  }
  /// Some of it, each its own way: which.
  std::vector<int> deform_some(test::Random& random) {
    std::vector<int> moved;
    for (int k = 0; k < 25; ++k) {
      moved.push_back(static_cast<int>(random.bits() % rest.size()));
      now[static_cast<std::size_t>(moved.back())] += random.vector(0.03);
    }
    return moved;
  }
  Vec3 place(test::Random& random) const {
    const Vec3 fraction = random.vector(0.75);
    return box.center() + fraction.cwiseProduct(box.sizes());
  }
  Surface surface;
  std::vector<Vec3> rest, now;
  Eigen::AlignedBox3d box;
};

TetMesh liver() {
  return read_mesh(test::source_dir() + "/configs/meshes/liver_paper.msh");
}

/// A cube of edges 8 mm, 80 mm wide, drawn into a ball: many of its triangles are equally far from its
/// middle.
TetMesh ball() {
  std::vector<double> line;
  for (int i = -5; i <= 5; ++i) line.push_back(0.008 * i);
  TetMesh mesh = grid_block(line, line, line);
  for (Vec3& x : mesh.vertices) {
    if (x.norm() > 0) x *= x.cwiseAbs().maxCoeff() / x.norm();
  }
  return mesh;
}

double distance_of(const Skin& skin, const Vec3& p, const Vec3& q, const Triangle& t) {
  const Vec3 &a = skin.now[t[0]], &b = skin.now[t[1]], &c = skin.now[t[2]];
  if (p != q) return segment_triangle_distance(p, q, a, b, c);
  const auto w = closest_point(p, a, b, c).weight;
  return (p - w[0] * a - w[1] * b - w[2] * c).norm();
}

/// The triangles of the patch as they are numbered on the surface.
std::vector<Triangle> gathered(ContactFinder& finder, const Skin& skin, const Vec3& p, const Vec3& q,
                               double reach, ContactPatch& patch, std::span<const int> moved = {}) {
  finder.gather(skin.now, skin.rest, p, q, reach, patch, moved);
  std::vector<Triangle> triangles;
  for (const auto& t : patch.triangles)
    triangles.push_back({finder.vertices()[t[0]], finder.vertices()[t[1]], finder.vertices()[t[2]]});
  return triangles;
}

/// Vertices in the order in which the triangles name them.
std::vector<int> in_order(const std::vector<Triangle>& triangles) {
  std::vector<int> vertices;
  for (const Triangle& t : triangles) {
    for (const int vertex : t) {
      if (std::ranges::find(vertices, vertex) == vertices.end()) vertices.push_back(vertex);
    }
  }
  return vertices;
}

void check_gather(Skin skin, double reach, double length) {
  test::Random random(7);
  // Room for everything, so that nothing is left out.
  ContactFinder finder(skin.rest, skin.surface.triangles, skin.surface.triangles, 1, length);
  ContactPatch patch;
  patch.reserve(finder.max_nodes(), finder.max_triangles());
  std::size_t found = 0;
  for (int i = 0; i < 240; ++i) {
    std::vector<int> moved;  // since the last time
    if (i % 3 == 0) skin.deform(random);
    if (i % 3 > 0) moved = skin.deform_some(random);
    if (i % 6 == 2) finder.nearest_vertex(skin.rest, skin.place(random));  // of another surface
    const Vec3 p = skin.place(random), q = length == 0 ? p : p + length * random.vector(1).normalized();
    std::vector<Triangle> expected;
    for (const Triangle& t : skin.surface.triangles) {
      if (distance_of(skin, p, q, t) <= reach) expected.push_back(t);
    }
    CHECK(gathered(finder, skin, p, q, reach, patch, moved) == expected);
    const auto vertices = finder.vertices();
    CHECK(std::vector<int>(vertices.begin(), vertices.end()) == in_order(expected));
    found += expected.size();
  }
  CHECK(found > 300);
}

void check_nearest(Skin skin) {
  test::Random random(8);
  const auto& triangles = skin.surface.triangles;
  const ContactFinder finder(skin.rest, triangles, triangles, 0.01);
  for (int i = 0; i < 300; ++i) {
    if (i % 3 == 1) skin.deform(random);
    const Vec3 p = i % 10 == 0 ? Vec3(Vec3::Zero()) : skin.place(random);
    const auto to = [&](const Triangle& t) {
      const auto w = closest_point(p, skin.now[t[0]], skin.now[t[1]], skin.now[t[2]]).weight;
      return (p - (w[0] * skin.now[t[0]] + w[1] * skin.now[t[1]] + w[2] * skin.now[t[2]])).squaredNorm();
    };
    const auto closer = [&](const Triangle& a, const Triangle& b) { return to(a) < to(b); };
    const auto foot = finder.foot(skin.now, p);
    CHECK(foot.triangle == *std::ranges::min_element(triangles, closer));
    CHECK((foot.of(skin.now) - p).squaredNorm() == to(foot.triangle));
    int corner = triangles.front()[0];
    for (const Triangle& t : triangles) {
      for (const int vertex : t) {
        if ((skin.now[vertex] - p).squaredNorm() < (skin.now[corner] - p).squaredNorm()) corner = vertex;
      }
    }
    CHECK(finder.nearest_vertex(skin.now, p) == corner);
  }
}

/// A surface crowded into a tenth of its size, more of which is near than there is room for: those kept are
/// nearer than all that are not, within the room, and the next look, a ninth farther, would not have fitted.
void check_crowded(Skin skin, double length) {
  test::Random random(11);
  constexpr double kReach = 0.02;
  ContactFinder finder(skin.rest, skin.surface.triangles, skin.surface.triangles, kReach, length);
  for (Vec3& x : skin.now) x *= 0.1;
  ContactPatch patch;
  patch.reserve(finder.max_nodes(), finder.max_triangles());
  for (int i = 0; i < 30; ++i) {
    const Vec3 p = 0.1 * skin.place(random), q = p + 0.1 * length * random.vector(1).normalized();
    const auto stored = gathered(finder, skin, p, q, kReach, patch);
    REQUIRE(stored.size() <= static_cast<std::size_t>(finder.max_triangles()));
    REQUIRE(finder.vertices().size() <= static_cast<std::size_t>(finder.max_nodes()));
    REQUIRE(patch.free.size() == finder.vertices().size());
    const auto is_stored = [&](const Triangle& t) { return std::ranges::find(stored, t) != stored.end(); };
    double max_stored = 0, nearest_remaining = kReach;
    for (const Triangle& t : skin.surface.triangles) {
      const double distance = distance_of(skin, p, q, t);
      if (is_stored(t)) {
        max_stored = std::max(max_stored, distance);
      } else {
        nearest_remaining = std::min(nearest_remaining, distance);
      }
    }
    CHECK(max_stored <= nearest_remaining);
    CHECK(stored.size() < skin.surface.triangles.size());
    std::vector<Triangle> next;
    for (const Triangle& t : skin.surface.triangles) {
      if (distance_of(skin, p, q, t) <= nearest_remaining / 0.9) next.push_back(t);
    }
    CHECK((next.size() > static_cast<std::size_t>(finder.max_triangles()) ||
           in_order(next).size() > static_cast<std::size_t>(finder.max_nodes())));
  }
}

}  // namespace

TEST_CASE("the surface near a ball or an axis: as by looking at every triangle, on deforming surfaces") {
  check_gather(Skin(liver()), 0.02, 0);
  check_gather(Skin(liver()), 0.015, 0.06);
  check_gather(Skin(ball()), 0.012, 0);
  check_gather(Skin(ball()), 0.01, 0.05);
}

TEST_CASE("a surface more crowded than there is room for: the nearest of it stays") {
  check_crowded(Skin(ball()), 0);
  check_crowded(Skin(ball()), 0.05);
}

TEST_CASE("the nearest triangle and vertex: as by looking at every one, the first of equals") {
  check_nearest(Skin(liver()));
  check_nearest(Skin(ball()));
}

TEST_CASE("a hierarchy lists whose boxes meet a box in ascending order, of an empty surface, none") {
  Skin skin(ball());
  Bvh bvh(skin.rest, skin.surface.triangles);
  const auto all = bvh.near(skin.box);
  CHECK(all.size() == skin.surface.triangles.size());
  CHECK(std::ranges::is_sorted(all));
  const Eigen::AlignedBox3d far(Vec3(1, 1, 1), Vec3(2, 2, 2));
  CHECK(bvh.near(far).empty());
  for (Vec3& x : skin.rest) x += Vec3(1.5, 1.5, 1.5);
  bvh.refit(skin.rest);
  CHECK(bvh.near(far).size() == skin.surface.triangles.size());
  Bvh none({}, {});
  none.refit({});
  CHECK(none.near(far).empty());
  CHECK(none.nearest(far, [](int) { return 0.0; }) == -1);
}

TEST_CASE("finding the near and the nearest does not allocate") {
  Skin skin(liver());
  test::Random random(9);
  skin.deform(random);
  ContactFinder finder(skin.rest, skin.surface.triangles, skin.surface.triangles, 0.02, 0.1);
  ContactPatch patch;
  patch.reserve(finder.max_nodes(), finder.max_triangles());
  std::size_t allocations = 1;
  {
    const test::AllocationGuard guard;
    for (int i = 0; i < 50; ++i) {
      const Vec3 p = skin.place(random);
      finder.gather(skin.now, skin.rest, p, p + Vec3(0.05, 0, 0), 0.02, patch);
      finder.foot(skin.now, p);
      finder.nearest_vertex(skin.now, p);
    }
    allocations = guard.count();
  }
  CHECK(allocations == 0);
}

TEST_CASE("after changes the hierarchy finds what one that is built anew finds") {
  test::Random random(17);
  Skin skin(liver());
  std::vector<Triangle> now = skin.surface.triangles;
  Bvh changed(skin.rest, now);
  for (int round = 0; round < 120; ++round) {
    const std::vector<Triangle> before = now;
    for (int k = 0; k < 7; ++k) {  // some go as the last takes their place, some are new, some are others
      const std::size_t at = random.bits() % now.size();
      if (k % 2 == 0 && now.size() > 20) {
        now[at] = now.back();
        now.pop_back();
      }
      const auto any = [&] { return static_cast<int>(random.bits() % skin.rest.size()); };
      if (k % 3 != 0) now.push_back({any(), any(), any()});
    }
    if (round == 60) now.resize(3);
    changed.change(skin.rest, before, now);
    Bvh anew(skin.rest, now);
    skin.deform(random);
    changed.refit(skin.now);
    anew.refit(skin.now);
    const Vec3 p = skin.place(random);
    const auto squared = [&](int i) {
      const double d = distance_of(skin, p, p, now[static_cast<std::size_t>(i)]);
      return d * d;
    };
    const Eigen::AlignedBox3d at(p, p), around(p.array() - 0.02, p.array() + 0.02);
    CHECK(changed.nearest(at, squared) == anew.nearest(at, squared));
    // Both give all that meets the box, and some neighbours.
    for (Bvh* const bvh : {&changed, &anew}) {
      const auto near = bvh->near(around);
      CHECK(std::ranges::is_sorted(near));
      CHECK(std::ranges::adjacent_find(near) == near.end());
      for (int i = 0; i < static_cast<int>(now.size()); ++i) {
        Eigen::AlignedBox3d box;
        for (const int v : now[static_cast<std::size_t>(i)])
          box.extend(skin.now[static_cast<std::size_t>(v)]);
        if (box.intersects(around)) CHECK(std::ranges::binary_search(near, i));
      }
    }
  }
}
