#include "sim_server/mesh/cut_mesh.h"

#include <algorithm>
#include <random>

#include "sim_server/mesh/pieces.h"
#include "tests/support/catch.h"
#include "tests/support/cut_bodies.h"
#include "tests/support/solids.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

struct Cutting {
  explicit Cutting(TetMesh made) : mesh(std::move(made)) {}
  TetMesh mesh;
  Surface surface = boundary_surface(mesh);
  CutMesh cut{mesh, std::vector<char>(mesh.tetrahedra.size(), 1), surface};
};

/// Pieces of what is left that hang together by faces, by a flood from each tetrahedron: the tetrahedra.
std::vector<std::vector<int>> flooded_pieces(const TetMesh& mesh, const CutMesh& cut) {
  std::vector<std::vector<int>> pieces;
  std::vector<char> seen(mesh.tetrahedra.size());
  for (int from = 0; from < static_cast<int>(seen.size()); ++from) {
    if (!cut.remains(from) || seen[from] != 0) continue;
    std::vector<int> piece{from};
    seen[from] = 1;
    for (std::size_t i = 0; i < piece.size(); ++i) {
      for (const int other : cut.neighbours(piece[i])) {
        if (other < 0 || seen[other] != 0) continue;
        seen[other] = 1;
        piece.push_back(other);
      }
    }
    std::ranges::sort(piece);
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

}  // namespace

TEST_CASE("the surface of what is left is that of a mesh of what is left, after each removal") {
  Cutting body(test::corner_block(Vec3(3, 2, 2), {3, 2, 2}));
  std::vector<int> order(body.mesh.tetrahedra.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::ranges::shuffle(order, std::minstd_rand(7));
  for (const int t : order) {
    body.cut.remove({&t, 1}, body.surface);
    const auto triangles = by_mesh_vertices(body.surface);
    CHECK(in_order(triangles) == in_order(outer_faces(rest_of(body.mesh, body.cut)).triangles));
    CHECK(open_edges(triangles) == 0);
    for (std::size_t slot = 0; slot < triangles.size(); ++slot)
      CHECK(body.cut.remains(body.cut.tetrahedron_of(slot)));
    for (int v = 0; v < static_cast<int>(body.surface.vertices.size()); ++v) {
      const bool used = std::ranges::any_of(body.surface.triangles, [v](const Triangle& triangle) {
        return std::ranges::count(triangle, v) > 0;
      });
      CHECK(body.cut.on_surface(v) == used);
    }
  }
  CHECK(body.cut.count() == 0);
  CHECK(body.surface.triangles.empty());
}

TEST_CASE("only what may be removed gives the surface its vertices") {
  TetMesh mesh = test::corner_block(Vec3(4, 4, 4), {4, 4, 4});
  Surface surface = boundary_surface(mesh);
  const std::size_t outside = surface.vertices.size();
  std::vector<char> removable(mesh.tetrahedra.size(), 0);
  const CutMesh nothing(mesh, removable, surface);
  CHECK(surface.vertices.size() == outside);
  std::vector<char> is_corner(mesh.vertices.size(), 0);  // of what may go: one half
  for (const int v : surface.vertices) is_corner[static_cast<std::size_t>(v)] = 1;
  for (std::size_t t = 0; t < mesh.tetrahedra.size() / 2; ++t) {
    removable[t] = 1;
    for (const int v : mesh.tetrahedra[t]) is_corner[static_cast<std::size_t>(v)] = 1;
  }
  const CutMesh half(mesh, removable, surface);
  CHECK(surface.vertices.size() == static_cast<std::size_t>(std::ranges::count(is_corner, 1)));
  CHECK(surface.vertices.size() < mesh.vertices.size());
  removable.assign(removable.size(), 1);
  const CutMesh all(mesh, removable, surface);
  CHECK(surface.vertices.size() == mesh.vertices.size());
  CHECK(open_edges(by_mesh_vertices(surface)) == 0);
}

TEST_CASE("the area of a cut is that of the walls of a slit, and none once all is gone") {
  Cutting body(test::corner_block(Vec3(4, 1, 1), {4, 2, 2}));
  const auto remove = [&](double from, double to) {
    std::vector<int> gone;
    for (int t = 0; t < static_cast<int>(body.mesh.tetrahedra.size()); ++t) {
      double x = 0;
      for (const int v : body.mesh.tetrahedra[t]) x += body.mesh.vertices[v].x() / 4;
      if (body.cut.remains(t) && x >= from && x <= to) gone.push_back(t);
    }
    body.cut.remove(gone, body.surface);
    return body.cut.cut_area();
  };
  CHECK(remove(1, 2) == Approx(2));
  CHECK(remove(2, 3) == Approx(2));
  CHECK(std::abs(remove(0, 4)) < 1e-12);
}

TEST_CASE("what removals cut off is what a flood of the whole mesh finds") {
  std::minstd_rand random(11);
  int let_go_at_last = 0;  // bodies that lost the last that held them
  for (int round = 0; round < 20; ++round) {
    Cutting body(test::corner_block(Vec3(4, 2, 2), {4, 2, 2}));
    std::vector<int> held;
    for (int v = 0; v < static_cast<int>(body.mesh.vertices.size()); ++v) {
      if (body.mesh.vertices[v].x() == 0) held.push_back(v);
    }
    const auto is_held = [&](const std::vector<int>& piece) {
      return std::ranges::any_of(piece, [&](int t) {
        return std::ranges::any_of(body.mesh.tetrahedra[t],
                                   [&](int v) { return std::ranges::binary_search(held, v); });
      });
    };
    PieceFinder finder(body.cut, held);
    while (body.cut.count() > 0) {
      std::vector<int> remaining;
      for (int t = 0; t < static_cast<int>(body.mesh.tetrahedra.size()); ++t) {
        if (body.cut.remains(t)) remaining.push_back(t);
      }
      std::ranges::shuffle(remaining, random);
      remaining.resize(std::min<std::size_t>(remaining.size(), 1 + random() % 5));
      const auto before = flooded_pieces(body.mesh, body.cut);
      body.cut.remove(remaining, body.surface);
      const auto pieces = flooded_pieces(body.mesh, body.cut);
      const std::vector<Piece> found = finder.cut_off(body.cut, remaining);
      // Nothing but whole pieces, each once, and none is found where none came apart.
      for (const Piece& piece : found) {
        CHECK(std::ranges::count(pieces, piece.tetrahedra) == 1);
        CHECK(std::ranges::count(found, piece.tetrahedra, &Piece::tetrahedra) == 1);
        CHECK(piece.held == is_held(piece.tetrahedra));
      }
      // Of each body that there was, all pieces but one; that too, where nothing holds it any more.
      std::size_t cut_off = 0;
      for (const std::vector<int>& was : before) {
        std::size_t of_it = 0, held_of_it = 0;
        for (const std::vector<int>& piece : pieces) {
          if (!std::ranges::binary_search(was, piece.front())) continue;
          ++of_it;
          held_of_it += is_held(piece) ? 1 : 0;
        }
        const bool release = is_held(was) && held_of_it == 0;
        cut_off += of_it > 0 && !release ? of_it - 1 : of_it;
        let_go_at_last += release && of_it > 0 ? 1 : 0;
      }
      CHECK(found.size() == cut_off);
      // What is loose goes, as a resection may have it, or stays.
      for (const Piece& piece : found) {
        if (!piece.held && round % 2 == 0) body.cut.remove(piece.tetrahedra, body.surface);
      }
    }
  }
  CHECK(let_go_at_last > 5);
}

TEST_CASE("a held piece stays, however small it is beside a loose one") {
  Cutting body(test::corner_block(Vec3(6, 1, 1), {6, 1, 1}));
  std::vector<int> held;
  for (int v = 0; v < static_cast<int>(body.mesh.vertices.size()); ++v) {
    if (body.mesh.vertices[v].x() == 0) held.push_back(v);
  }
  PieceFinder finder(body.cut, held);
  std::vector<int> removed;
  for (int t = 0; t < static_cast<int>(body.mesh.tetrahedra.size()); ++t) {
    double x = 0;
    for (const int v : body.mesh.tetrahedra[t]) x += body.mesh.vertices[v].x() / 4;
    if (x < 1 || x > 2) continue;
    removed.push_back(t);
  }
  body.cut.remove(removed, body.surface);
  const std::vector<Piece> found = finder.cut_off(body.cut, removed);
  REQUIRE(found.size() == 1);
  CHECK_FALSE(found[0].held);
  CHECK(found[0].volume == Approx(4));
}

TEST_CASE("a piece goes whole with tissue that could not be cut, and leaves no surface behind") {
  const TetMesh mesh = test::corner_block(Vec3(8, 3, 3), {8, 3, 3});
  Surface surface = boundary_surface(mesh);
  std::vector<char> removable;
  std::vector<int> slit;
  for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t) {
    double x = 0;
    for (const int v : mesh.tetrahedra[t]) x += mesh.vertices[v].x() / 4;
    removable.push_back(x > 1 && x < 2 ? 1 : 0);
    if (removable.back() == 1) slit.push_back(t);
  }
  CutMesh cut(mesh, removable, surface);
  PieceFinder finder(cut, std::vector<int>{0});
  cut.remove(slit, surface);
  const std::vector<Piece> pieces = finder.cut_off(cut, slit);
  REQUIRE(pieces.size() == 1);
  cut.remove(pieces[0].tetrahedra, surface);
  CHECK(in_order(by_mesh_vertices(surface)) == in_order(outer_faces(rest_of(mesh, cut)).triangles));
  CHECK(cut.cut_area() == Approx(9));
}
