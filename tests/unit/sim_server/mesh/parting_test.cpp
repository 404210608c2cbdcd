#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "sim_server/elasticity/tensors.h"
#include "sim_server/mesh/cut_mesh.h"
#include "sim_server/mesh/pieces.h"
#include "sim_server/mesh/shapes.h"
#include "tests/support/catch.h"
#include "tests/support/soft_block.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

struct Body {
  explicit Body(const std::array<int, 3>& cells, std::vector<int> held_vertices = {})
      : mesh(deep_block(cells)), held(std::move(held_vertices)) {}
  TetMesh mesh;
  std::vector<int> held;
  Surface surface = boundary_surface(mesh);
  CutMesh cut{mesh, std::vector<char>(mesh.tetrahedra.size(), 1), surface, held};

  std::vector<int> inner_faces() const {
    std::vector<int> faces;
    for (int face = 0; face < static_cast<int>(4 * mesh.tetrahedra.size()); ++face) {
      if (cut.across(face) > face) faces.push_back(face);
    }
    return faces;
  }
};

std::array<int, 3> corners_of(const TetMesh& mesh, int face) {
  std::array<int, 3> corners{};
  for (int k = 0, i = 0; k < 4; ++k) {
    if (k != face % 4) corners[i++] = mesh.tetrahedra[face / 4][k];
  }
  std::ranges::sort(corners);
  return corners;
}

/// Bodies that hang together by faces that were not parted: of each tetrahedron the lowest of its own.
std::vector<int> bodies_without(const TetMesh& entire, const std::set<std::array<int, 3>>& separated) {
  std::map<std::array<int, 3>, std::vector<int>> sides;
  for (int face = 0; face < static_cast<int>(4 * entire.tetrahedra.size()); ++face)
    sides[corners_of(entire, face)].push_back(face / 4);
  std::vector<int> body(entire.tetrahedra.size());
  for (std::size_t t = 0; t < body.size(); ++t) body[t] = static_cast<int>(t);
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [corners, of] : sides) {
      if (of.size() < 2 || separated.contains(corners) || body[of[0]] == body[of[1]]) continue;
      body[of[0]] = body[of[1]] = std::min(body[of[0]], body[of[1]]);
      changed = true;
    }
  }
  return body;
}

/// Tetrahedra around each vertex of `mesh` that reach each other by faces with it: how many such fans it has.
int most_fans(const Body& body, const std::set<int>& stay_one) {
  int most = 0;
  for (int v = 0; v < static_cast<int>(body.mesh.vertices.size()); ++v) {
    if (stay_one.contains(v)) continue;
    std::set<int> around;
    for (int t = 0; t < static_cast<int>(body.mesh.tetrahedra.size()); ++t) {
      if (std::ranges::count(body.mesh.tetrahedra[t], v) > 0) around.insert(t);
    }
    CHECK(std::ranges::equal(around, body.cut.around(v)));
    int fans = 0;
    for (; !around.empty(); ++fans) {
      std::vector<int> fan{*around.begin()};
      around.erase(around.begin());
      for (std::size_t i = 0; i < fan.size(); ++i) {
        for (int k = 0; k < 4; ++k) {
          const int other = body.cut.across(4 * fan[i] + k);
          if (body.mesh.tetrahedra[fan[i]][k] == v || other < 0 || !around.contains(other / 4)) continue;
          around.erase(other / 4);
          fan.push_back(other / 4);
        }
      }
    }
    most = std::max(most, fans);
  }
  return most;
}

}  // namespace

TEST_CASE("parted faces are surface on both sides, and vertices are as many as there are fans around them") {
  Body body({6, 2, 6});
  const TetMesh entire = body.mesh;
  const double volume = describe(entire).volume, area = 2 * 0.04 * 0.04 + 4 * 0.04 * 0.02;
  std::minstd_rand random(5);
  std::set<std::array<int, 3>> separated;  // by corners of the whole mesh
  double separated_area = 0;
  PieceFinder finder(body.cut, {});
  std::size_t bodies = 1;
  for (int round = 0; round < 6; ++round) {
    // Some anywhere; then all in a plane, of which there are three.
    std::vector<int> faces = body.inner_faces();
    std::ranges::shuffle(faces, random);
    if (round % 2 == 0) {
      faces.resize(faces.size() / 40);
    } else {
      const Vec3 middle(0, -0.01, 0);
      std::erase_if(faces, [&](int face) {
        const auto side = [&](int t) {
          return centre_of(entire, entire.tetrahedra[t])[round / 2] > middle[round / 2];
        };
        return side(face / 4) == side(body.cut.across(face) / 4);
      });
    }
    for (const int face : faces) {
      const auto [a, b, c] = corners_of(entire, face);
      separated.insert({a, b, c});
      separated_area +=
          0.5 *
          (entire.vertices[b] - entire.vertices[a]).cross(entire.vertices[c] - entire.vertices[a]).norm();
    }
    const Parting parting = body.cut.part(faces, body.surface);
    REQUIRE_FALSE(parting.ran_out);
    CHECK(most_fans(body, {}) == 1);
    // The surface: each parted face twice, what was outside once; closed; of the right area.
    CHECK(body.surface.triangles.size() == boundary_surface(entire).triangles.size() + 2 * separated.size());
    CHECK(body.cut.cut_area() == Approx(2 * separated_area));
    double all = 0, six = 0;
    std::map<std::pair<int, int>, int> along;
    for (const Triangle& t : body.surface.triangles) {
      std::array<Vec3, 3> x;
      for (int i = 0; i < 3; ++i) {
        x[i] = body.mesh.vertices[body.surface.vertices[t[i]]];
        const int from = t[i], to = t[(i + 1) % 3];
        along[std::minmax(from, to)] += from < to ? 1 : -1;
      }
      all += 0.5 * (x[1] - x[0]).cross(x[2] - x[0]).norm();
      six += x[0].dot(x[1].cross(x[2]));
    }
    CHECK(std::ranges::all_of(along, [](const auto& edge) { return edge.second == 0; }));
    CHECK(all == Approx(area + 2 * separated_area));
    CHECK(six / 6 == Approx(volume));
    // Tetrahedra have the same corners as before, by place.
    for (std::size_t t = 0; t < entire.tetrahedra.size(); ++t) {
      for (int k = 0; k < 4; ++k)
        CHECK(body.mesh.vertices[body.mesh.tetrahedra[t][k]] == entire.vertices[entire.tetrahedra[t][k]]);
    }
    // Pieces.
    const std::vector<int> body_of = bodies_without(entire, separated);
    const std::vector<Piece> found = finder.separated(body.cut, parting.tetrahedra);
    const std::size_t now = std::set<int>(body_of.begin(), body_of.end()).size();
    CHECK(found.size() == now - bodies);
    bodies = now;
    for (const Piece& piece : found) {
      const int of = body_of[piece.tetrahedra.front()];
      CHECK(std::ranges::count(body_of, of) == static_cast<std::ptrdiff_t>(piece.tetrahedra.size()));
      for (const int t : piece.tetrahedra) CHECK(body_of[t] == of);
    }
  }
  CHECK(bodies >= 8);
}

TEST_CASE("a vertex that is held, or beside what cannot be cut, stays one") {
  TetMesh mesh = deep_block({4, 2, 4});
  Surface surface = boundary_surface(mesh);
  std::vector<char> removable;
  for (const Tetrahedron& t : mesh.tetrahedra) removable.push_back(centre_of(mesh, t).z() > 0 ? 1 : 0);
  std::vector<int> held;
  for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
    if (mesh.vertices[v].y() < -0.019) held.push_back(v);
  }
  CutMesh cut(mesh, removable, surface, held);
  std::vector<int> faces;
  for (int face = 0; face < static_cast<int>(4 * mesh.tetrahedra.size()); ++face) {
    if (cut.across(face) > face && cut.can_part(face)) faces.push_back(face);
  }
  const Parting parting = cut.part(faces, surface);
  CHECK(parting.splits.size() > 10);
  for (const Split& split : parting.splits) {
    CHECK(mesh.vertices[split.vertex].z() > 1e-9);
    CHECK(mesh.vertices[split.vertex].y() > -0.019);
  }
}

TEST_CASE("tensors after slides and partings are those of a fresh assembly") {
  Body body({6, 3, 6});
  const Material material{.young_modulus = 1e4, .poisson_ratio = 0.4};
  std::vector<int> standing;
  for (int v = 0; v < static_cast<int>(body.mesh.vertices.size()); ++v) {
    if (body.cut.around(v).empty() || body.mesh.vertices[v].y() < -0.019) standing.push_back(v);
  }
  ElasticTensors tensors(body.mesh, material, standing);
  std::minstd_rand random(5);
  for (int round = 0; round < 6; ++round) {
    std::vector<int> reshaped;
    for (int i = 0; i < 10; ++i) {
      const int v = static_cast<int>(random() % (7 * 4 * 7));
      Vec3 x = body.mesh.vertices[v];
      for (double& coordinate : x) coordinate += 1e-4 * (static_cast<double>(random() % 100) / 50 - 1);
      body.cut.move_vertex(v, x);
      for (const int t : body.cut.around(v)) reshaped.push_back(t);
    }
    std::vector<int> faces = body.inner_faces();
    std::ranges::shuffle(faces, random);
    faces.resize(faces.size() / 5);
    tensors.part(body.cut.part(faces, body.surface), reshaped, body.cut, material);
    const std::vector<int> removed{static_cast<int>(random() % body.mesh.tetrahedra.size())};
    if (!body.cut.remains(removed[0])) continue;
    body.cut.remove(removed, body.surface);
    tensors.remove(removed, body.cut, material);
  }
  TetMesh remaining = body.mesh;
  remaining.tetrahedra.clear();
  for (int t = 0; t < static_cast<int>(body.mesh.tetrahedra.size()); ++t) {
    if (body.cut.remains(t)) remaining.tetrahedra.push_back(body.mesh.tetrahedra[t]);
  }
  std::vector<int> still;
  for (int v = 0; v < static_cast<int>(remaining.vertices.size()); ++v) {
    if (tensors.places()[v] < 0) still.push_back(v);
  }
  const ElasticTensors fresh(remaining, material, still);
  REQUIRE(fresh.vertices() == tensors.vertices());
  REQUIRE(fresh.vertices() > 300);
  std::vector<double> x(3 * fresh.masses().size()), y(x.size()), x_fresh(x.size()), y_fresh(x.size());
  for (double& value : x) value = static_cast<double>(random()) / std::minstd_rand::max() - 0.5;
  for (std::size_t v = 0; v < remaining.vertices.size(); ++v) {
    const int at = tensors.places()[v], at_fresh = fresh.places()[v];
    for (int i = 0; at >= 0 && i < 3; ++i) x_fresh[3 * at_fresh + i] = x[3 * at + i];
  }
  tensors.multiply(x.data(), y.data());
  fresh.multiply(x_fresh.data(), y_fresh.data());
  const double size = *std::ranges::max_element(y);
  for (std::size_t v = 0; v < remaining.vertices.size(); ++v) {
    const int at = tensors.places()[v], at_fresh = fresh.places()[v];
    for (int i = 0; at >= 0 && i < 3; ++i)
      CHECK(std::abs(y[3 * at + i] - y_fresh[3 * at_fresh + i]) < 1e-12 * size);
    if (at >= 0 && fresh.masses()[at_fresh] > 0)
      CHECK(tensors.masses()[at] == Approx(fresh.masses()[at_fresh]).epsilon(1e-12));
  }
}

TEST_CASE("a product of tensors in parts is that in one, also where vertices have become two") {
  Body body({27, 27, 27});
  const Material material{.young_modulus = 1e4, .poisson_ratio = 0.4};
  std::vector<int> standing;
  for (int v = 0; v < static_cast<int>(body.mesh.vertices.size()); ++v) {
    if (body.cut.around(v).empty()) standing.push_back(v);
  }
  ElasticTensors tensors(body.mesh, material, standing);
  ElasticTensors::Ahead ahead = tensors.room_ahead();
  REQUIRE(ahead.size() == 16);
  std::minstd_rand random(5);
  const auto check_same = [&] {
    std::vector<double> x(3 * tensors.masses().size()), in_one(x.size()), apart, in_parts;
    for (double& value : x) value = static_cast<double>(random()) / std::minstd_rand::max() - 0.5;
    tensors.multiply(x.data(), in_one.data());
    for (std::size_t k = 0; k < x.size(); k += 3)
      apart.insert(apart.end(), {x[k], x[k + 1], x[k + 2], 1e300});
    in_parts.resize(apart.size());
    const double size = std::abs(*std::ranges::max_element(in_one));
    for (int again = 0; again < 2; ++again) {
      for (std::size_t p = 0; p < tensors.parts(); ++p)
        tensors.multiply_part(p, apart.data(), in_parts.data(), ahead);
      for (std::size_t p = 0; p < tensors.parts(); ++p) tensors.gather_part(p, in_parts.data(), ahead);
      double off = 0;
      for (std::size_t i = 0; i < x.size(); ++i)
        off = std::max(off, std::abs(in_parts[i / 3 * 4 + i % 3] - in_one[i]));
      CHECK(off < 1e-13 * size);
    }
    // One vertex of it alone, also one that is the copy of another.
    for (const std::size_t place : {std::size_t{0}, x.size() / 7, x.size() / 3 - 1}) {
      std::vector<double> alone(x.size(), 0), sum(apart.size(), 0);
      const Vec3 at(x[3 * place], x[3 * place + 1], x[3 * place + 2]);
      Eigen::Map<Vec3>(alone.data() + 3 * place) = at;
      tensors.multiply(alone.data(), in_one.data());
      tensors.add_product(static_cast<int>(place), at, sum.data());
      double off = 0;
      for (std::size_t i = 0; i < x.size(); ++i)
        off = std::max(off, std::abs(sum[i / 3 * 4 + i % 3] - in_one[i]));
      CHECK(off < 1e-13 * size);
    }
  };
  check_same();
  const std::size_t before = tensors.masses().size();
  for (int round = 0; round < 3; ++round) {
    std::vector<int> faces = body.inner_faces();
    std::ranges::shuffle(faces, random);
    faces.resize(faces.size() / 3);
    tensors.part(body.cut.part(faces, body.surface), {}, body.cut, material);
    check_same();
  }
  CHECK(tensors.masses().size() > before + 100);
}
