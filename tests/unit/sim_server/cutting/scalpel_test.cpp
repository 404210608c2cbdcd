#include "sim_server/cutting/scalpel.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim_server/mesh/pieces.h"
#include "tests/support/catch.h"
#include "tests/support/shaken_block.h"

using namespace palpate;
using namespace palpate::sim;
using namespace palpate::test;

namespace {

constexpr double kDepth = 0.02;  // m

/// A body at rest under a blade that goes along a plane.
struct Cut {
  explicit Cut(const std::array<int, 3>& cells) : mesh(shaken_block(cells)) {
    for (const int v : surface.vertices) places.push_back(mesh.vertices[v]);
  }
  TetMesh mesh;
  Surface surface = boundary_surface(mesh);
  CutMesh cut{mesh, std::vector<char>(mesh.tetrahedra.size(), 1), surface, {}};
  std::vector<Vec3> places;
  Scalpel scalpel{cut};
  PieceFinder finder{cut, {}};
  std::vector<Piece> pieces;
  std::size_t slides = 0;
  Vec3 trail = Vec3::Zero();

  void go(const BladeEdge& was, const BladeEdge& is) {
    std::vector<Vec3> were = places;
    const Stroke stroke = scalpel.cut({was, is, trail}, were, places, cut);
    if (stroke.moved) trail = stroke.trail;
    slides += stroke.slides.size();
    const Parting parting = cut.part(stroke.faces, surface);
    for (const Split& split : parting.splits)
      places[cut.number_of(split.copy)] = places[cut.number_of(split.vertex)];
    for (Piece& piece : finder.separated(cut, parting.tetrahedra)) pieces.push_back(std::move(piece));
  }
  /// From outside to outside, in so many steps: turned by `turn` (rad) about z, and by `lean` about x.
  void go_through(double x, double turn, double lean, int steps) {
    const Quat q(Eigen::AngleAxisd(turn, Vec3::UnitZ()) * Eigen::AngleAxisd(lean, Vec3::UnitY()));
    const Vec3 along = q * Vec3(0, -1, 0), ahead = q * Vec3(0, 0, 1), from(x, 0.02, 0);
    const auto edge_at = [&](double fraction) {
      const Vec3 a = from + (2 * fraction - 1) * 0.04 * ahead;
      return BladeEdge{a, a + 0.06 * along};
    };
    for (int i = 1; i <= steps; ++i) go(edge_at((i - 1.0) / steps), edge_at(static_cast<double>(i) / steps));
  }
};

/// Of the cut, from that plane: the root of the mean square, m.
double roughness(const Cut& body, const Vec3& point, const Vec3& normal) {
  double sum = 0, count = 0;
  for (std::size_t v = 0; v < body.mesh.vertices.size(); ++v) {
    if (body.cut.around(static_cast<int>(v)).empty() || !body.cut.on_cut(static_cast<int>(v))) continue;
    sum += std::pow(normal.dot(body.mesh.vertices[v] - point), 2);
    ++count;
  }
  return std::sqrt(sum / count);
}
}  // namespace

TEST_CASE("a blade that went through a body has cut it in two, however fast it went, along its plane") {
  for (const int steps : {1, 9, 60, 500}) {
    for (const auto& [x, turn, lean] :
         {std::tuple(0.0021, 0.0, 0.0), std::tuple(-0.0043, 0.3, 0.0), std::tuple(0.0067, -0.2, 0.4)}) {
      CAPTURE(steps, x, turn, lean);
      Cut body({12, 6, 12});
      body.go_through(x, turn, lean, steps);
      // In two: small pieces at most where the plane met the border at a corner of a tetrahedron.
      const double volume = 0.04 * kDepth * 0.04;
      std::vector<double> volumes;
      for (const Piece& piece : body.pieces) volumes.push_back(piece.volume);
      REQUIRE(!volumes.empty());
      std::ranges::sort(volumes, std::greater());
      const Quat q(Eigen::AngleAxisd(turn, Vec3::UnitZ()) * Eigen::AngleAxisd(lean, Vec3::UnitY()));
      const Vec3 normal = q * Vec3::UnitX(), point(x, 0.02, 0);
      double right = 0;  // on its side, by many points
      const int n = 60;
      for (int i = 0; i < n * n * n; ++i) {
        const Vec3 p(0.04 * ((i % n + 0.5) / n - 0.5), -kDepth * ((i / n % n + 0.5) / n),
                     0.04 * ((i / n / n + 0.5) / n - 0.5));
        right += normal.dot(p - point) > 0 ? volume / (n * n * n) : 0;
      }
      const double smaller = std::min(right, volume - right);
      CHECK(volumes[0] == Approx(smaller).epsilon(0.03));
      CHECK(std::accumulate(volumes.begin() + 1, volumes.end(), 0.0) < 1e-3 * volume);
      CHECK(roughness(body, point, normal) < 0.12 * body.scalpel.size());
    }
  }
}

TEST_CASE("what another tool touches does not slide onto the way of a blade, as long as it does") {
  Cut body({12, 6, 12});
  std::vector<int> all(body.mesh.vertices.size());
  std::iota(all.begin(), all.end(), 0);
  body.scalpel.keep(all);
  body.go_through(-0.0071, 0, 0, 20);
  CHECK(body.slides == 0);
  body.trail.setZero();
  body.scalpel.keep({});
  body.go_through(0.0062, 0, 0, 20);
  CHECK(body.slides > 20);
}

TEST_CASE("tissue that trembles under a blade is parted as tissue at rest is") {
  const auto separated_area = [](double trembles) {  // m, across the way of the blade
    Cut body({12, 6, 12});
    const std::vector<Vec3> rest = body.places;
    std::vector<Vec3> were = body.places;
    BladeEdge was{};
    constexpr int kSteps = 3000;
    for (int i = 0; i <= kSteps; ++i) {
      const Vec3 top(0.0021, 0.02, 0.08 * i / kSteps - 0.04);
      const BladeEdge is{top, top - Vec3(0, 0.06, 0)};
      if (i == 0) was = is;
      const Vec3 shift(trembles * std::sin(2.4 * i), 0, 0.5 * trembles * std::sin(1.7 * i));
      std::vector<Vec3> are = body.places;
      for (std::size_t v = 0; v < rest.size(); ++v) are[v] += shift;
      const Stroke stroke = body.scalpel.cut({was, is, body.trail}, were, are, body.cut);
      if (!stroke.moved) continue;
      const Parting parting = body.cut.part(stroke.faces, body.surface);
      for (const CuttableModel::Slide& slide : stroke.slides) {
        Vec3& x = body.places[body.cut.number_of(slide.vertex)];
        x += slide.fraction * (body.places[body.cut.number_of(slide.towards)] - x);
      }
      for (const Split& split : parting.splits) {
        body.places[body.cut.number_of(split.copy)] = body.places[body.cut.number_of(split.vertex)];
        are[body.cut.number_of(split.copy)] = are[body.cut.number_of(split.vertex)];
      }
      was = is;
      were = are;
      body.trail = stroke.trail;
    }
    return body.cut.cut_area();
  };
  const double still = separated_area(0);
  REQUIRE(still > 2 * 0.04 * kDepth);
  CHECK(separated_area(1e-4) == Approx(still).epsilon(0.15));
}
