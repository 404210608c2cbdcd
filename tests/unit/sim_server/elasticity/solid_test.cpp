// Bodies of all laws and elements: forces are the derivative of the energy, stiffness that of the forces.
#include "sim_server/elasticity/solid.h"

#include <future>

#include "sim_server/elasticity/inversion.h"
#include "sim_server/mesh/shapes.h"
#include "tests/support/catch.h"
#include "tests/support/random.h"

#ifdef PALPATE_WITH_TBB
#include <oneapi/tbb/global_control.h>
#endif

using namespace palpate;
using namespace palpate::sim;

namespace {

constexpr std::array kLaws{ElasticLaw::kLinear, ElasticLaw::kCorotational, ElasticLaw::kStVenantKirchhoff,
                           ElasticLaw::kNeoHookean};
constexpr std::array kElements{ElementKind::kLinear, ElementKind::kNodalPressure, ElementKind::kQuadratic};

Material tissue(ElasticLaw law, ElementKind element) {
  return {7e3, 0.4, 1000, law, element, Fibres{Vec3(1, 1, 0).normalized(), 3e3}, {}};
}

TetMesh shaken_block() {
  TetMesh mesh = grid_block({0, 0.3, 0.7}, {0, 0.4, 0.8}, {0, 0.5, 0.9});
  test::Random random(7);
  for (Vec3& x : mesh.vertices) x += random.vector(0.03);
  return mesh;
}

std::vector<Vec3> deformed(const Solid& solid, double size) {
  test::Random random(8);
  std::vector<Vec3> x = solid.rest();
  Mat3 stretch;
  stretch << 1.1, 0.1, 0, -0.05, 0.95, 0.1, 0, 0.05, 1.05;
  for (Vec3& p : x) p = stretch * p + random.vector(size);
  return x;
}

Eigen::VectorXd forces(const Solid& solid, const std::vector<Vec3>& x, const Viscosity& viscosity = {}) {
  std::vector<Vec3> f(x.size());
  solid.forces(x, f, viscosity);
  return Eigen::Map<Eigen::VectorXd>(f.front().data(), static_cast<Eigen::Index>(3 * f.size()));
}

Eigen::MatrixXd stiffness(const Solid& solid, const std::vector<Vec3>& x, const Viscosity& viscosity = {}) {
  const FreeDofs dofs(solid.nodes(), {});
  StiffnessMatrix k = solid.stiffness_matrix(dofs);
  solid.add_stiffness(x, k, viscosity);
  const Eigen::MatrixXd lower = k.lower();
  return lower.selfadjointView<Eigen::Lower>();
}

template <class Work>
void each_solid(const Work& work) {
  for (const ElasticLaw law : kLaws) {
    for (const ElementKind element : kElements) {
      DYNAMIC_SECTION("law " << static_cast<int>(law) << ", element " << static_cast<int>(element)) {
        work(Solid(with_nodes(shaken_block(), element), tissue(law, element)));
      }
    }
  }
}

}  // namespace

TEST_CASE("solid: forces are the derivative of the energy, stiffness that of the forces, symmetric") {
  each_solid([](const Solid& solid) {
    const std::vector<Vec3> x = deformed(solid, 0.02);
    const Eigen::VectorXd f = forces(solid, x);
    const Eigen::MatrixXd k = stiffness(solid, x);
    test::Random random(9);
    for (int round = 0; round < 4; ++round) {
      const double h = 1e-6;
      std::vector<Vec3> way, plus = x, minus = x;
      for (std::size_t i = 0; i < x.size(); ++i) {
        way.push_back(random.vector(1));
        plus[i] += h * way[i];
        minus[i] -= h * way[i];
      }
      const Eigen::Map<const Eigen::VectorXd> d(way.front().data(), f.size());
      CHECK(f.dot(d) == Approx((solid.energy(plus) - solid.energy(minus)) / (2 * h)).epsilon(1e-6));
      const Eigen::VectorXd turned = (forces(solid, plus) - forces(solid, minus)) / (2 * h);
      CHECK((k * d - turned).norm() < 1e-7 * turned.norm());
    }
  });
}

TEST_CASE("solid: with stress that is remembered, stiffness is the derivative of the forces") {
  each_solid([](const Solid& solid) {
    std::vector<Mat3> memory(solid.points());
    test::Random random(10);
    for (Mat3& each : memory) {
      each << random.vector(500), random.vector(500), random.vector(500);
      each = (0.5 * (each + each.transpose())).eval();
    }
    const Viscosity viscosity{0.6, memory};
    std::vector<Vec3> x = deformed(solid, 0.02), plus = x, minus = x, way;
    const double h = 1e-6;
    for (std::size_t i = 0; i < x.size(); ++i) {
      way.push_back(random.vector(1));
      plus[i] += h * way[i];
      minus[i] -= h * way[i];
    }
    const Eigen::VectorXd turned =
        (forces(solid, plus, viscosity) - forces(solid, minus, viscosity)) / (2 * h);
    const Eigen::Map<const Eigen::VectorXd> d(way.front().data(), turned.size());
    CHECK((stiffness(solid, x, viscosity) * d - turned).norm() < 1e-7 * turned.norm());
  });
}

TEST_CASE("solid: no force and no energy at rest or shifted, turned, only the linear law has them") {
  each_solid([](const Solid& solid) {
    const double scale = stiffness(solid, solid.rest()).norm();
    CHECK(forces(solid, solid.rest()).norm() < 1e-14 * scale);
    const Mat3 turn = Eigen::AngleAxisd(1.5, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    std::vector<Vec3> moved = solid.rest(), turned = solid.rest();
    for (Vec3& x : moved) x += Vec3(0.3, -0.2, 0.1);
    for (Vec3& x : turned) x = turn * x;
    CHECK(forces(solid, moved).norm() < 1e-13 * scale);
    const bool linear = solid.material().law == ElasticLaw::kLinear;
    CHECK((forces(solid, turned).norm() < 1e-13 * scale) == !linear);
    for (const std::vector<Vec3>& x : {solid.rest(), moved}) CHECK(std::abs(solid.energy(x)) < 1e-14 * scale);
    CHECK((std::abs(solid.energy(turned)) < 1e-14 * scale) == !linear);
  });
}

TEST_CASE("solid: patch test: under one strain everywhere the inner nodes feel no force, to 1e-12") {
  each_solid([](const Solid& solid) {
    std::vector<Vec3> x = solid.rest();
    Mat3 F;
    F << 1.02, 0.01, 0, -0.01, 0.99, 0.02, 0.01, 0, 1.01;
    for (Vec3& p : x) p = F * p;
    const Eigen::VectorXd f = forces(solid, x);
    constexpr int kMiddle = 13;  // of 3 x 3 x 3 vertices the only one inside
    CHECK(f.segment<3>(3 * kMiddle).norm() < 1e-12 * f.norm());
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < solid.nodes(); ++i) sum += f.segment<3>(3 * i);
    CHECK(sum.norm() < 1e-12 * f.norm());
  });
}

TEST_CASE("solid: masses add up to density times volume") {
  for (const ElementKind element : kElements) {
    const Solid solid(with_nodes(shaken_block(), element), tissue(ElasticLaw::kLinear, element));
    double volume = 0, mass = 0;
    for (std::size_t p = 0; p < solid.points(); ++p) volume += solid.volume_of(p);
    for (const double each : solid.masses()) mass += each;
    CHECK(mass == Approx(1000 * volume).epsilon(1e-12));
  }
}

TEST_CASE("solid: reshaped, it is the body that another mesh would have made") {
  TetMesh mesh = shaken_block();
  mesh.stiffness.assign(mesh.tetrahedra.size(), 1);
  for (std::size_t t = 0; t < mesh.stiffness.size(); t += 3) mesh.stiffness[t] = 5;
  mesh.vertices.emplace_back(0.1, 0.2, 0.3);  // of no tetrahedron yet
  Solid solid(mesh, tissue(ElasticLaw::kCorotational, ElementKind::kLinear));
  const auto spare = static_cast<int>(mesh.vertices.size()) - 1;
  constexpr int kMiddle = 13;
  mesh.vertices[kMiddle] += Vec3(0.02, -0.01, 0.03);
  mesh.vertices.back() = mesh.vertices[kMiddle];
  std::vector<int> changed;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    Tetrahedron& corners = mesh.tetrahedra[t];
    const auto corner = std::ranges::find(corners, kMiddle);
    if (corner == corners.end()) continue;
    if (t % 2 == 0) *corner = spare;
    changed.push_back(static_cast<int>(t));
  }
  REQUIRE(changed.size() > 8);
  solid.reshape(mesh, changed);
  const Solid other(mesh, tissue(ElasticLaw::kCorotational, ElementKind::kLinear));
  const std::vector<Vec3> x = deformed(other, 0.02);
  CHECK(solid.rest() == other.rest());
  CHECK(solid.masses() == other.masses());
  CHECK(forces(solid, x) == forces(other, x));
  CHECK(stiffness(solid, x) == stiffness(other, x));
}

#ifdef PALPATE_WITH_TBB
TEST_CASE("solid: the same bytes with one thread and two") {
  std::vector<double> lines;
  for (int i = 0; i <= 12; ++i) lines.push_back(0.1 * i);
  const Solid solid(grid_block(lines, lines, lines),
                    tissue(ElasticLaw::kCorotational, ElementKind::kNodalPressure));
  const std::vector<Vec3> x = deformed(solid, 0.01);
  Eigen::VectorXd f[2];
  SparseMatrix k[2];
  double e[2];
  for (const int threads : {1, 2}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                            static_cast<std::size_t>(threads));
    f[threads - 1] = forces(solid, x);
    StiffnessMatrix matrix = solid.stiffness_matrix(FreeDofs(solid.nodes(), {}));
    solid.add_stiffness(x, matrix);
    k[threads - 1] = matrix.lower();
    e[threads - 1] = solid.energy(x);
  }
  CHECK(f[0] == f[1]);
  CHECK(Eigen::Map<Eigen::VectorXd>(k[0].valuePtr(), k[0].nonZeros()) ==
        Eigen::Map<Eigen::VectorXd>(k[1].valuePtr(), k[1].nonZeros()));
  CHECK(e[0] == e[1]);
}
#endif

TEST_CASE("a tetrahedron pushed through itself is inverted, a sliver that turns over is not told of") {
  const std::vector<Vec3> corners{{0, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}};
  for (const auto& [height, published] :
       {std::pair(0.008, true), std::pair(0.0005, true), std::pair(0.00002, false)}) {
    CAPTURE(height);
    TetMesh mesh{.vertices = corners, .tetrahedra = {{0, 1, 2, 3}}, .surface_tags = {}};
    mesh.vertices.push_back(Vec3(0.002, 0.002, height));
    const Solid solid(mesh, {});
    std::vector<Vec3> x = solid.rest();
    CHECK_FALSE(any_inverted(solid, x));
    x[3][2] = 1e-9;
    CHECK_FALSE(any_inverted(solid, x));
    x[3][2] = -1e-9;
    CHECK(any_inverted(solid, x) == published);
  }
}

TEST_CASE("solid: threads that ask at once, each with its own scratch, get what one gets", "[threads]") {
  const Solid solid(shaken_block(), tissue(ElasticLaw::kNeoHookean, ElementKind::kNodalPressure));
  const std::vector<Vec3> near = deformed(solid, 0.01), far = deformed(solid, 0.05);
  const auto many = [&](const std::vector<Vec3>& x) {
    Solid::Scratch scratch(solid);
    std::vector<Vec3> sum(x.size(), Vec3::Zero()), f(x.size());
    for (int i = 0; i < 300; ++i) {
      solid.forces(x, f, {}, scratch);
      for (std::size_t k = 0; k < f.size(); ++k) sum[k] += f[k];
    }
    return sum;
  };
  const std::vector<Vec3> alone_near = many(near), alone_far = many(far);
  auto other = std::async(std::launch::async, many, far);
  CHECK(many(near) == alone_near);
  CHECK(other.get() == alone_far);
}
