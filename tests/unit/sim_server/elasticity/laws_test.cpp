// Elastic laws at a point, against finite differences of their own energy, linear elasticity, and closed
// forms.
#include "sim_server/elasticity/laws.h"

#include <Eigen/LU>

#include "sim_server/elasticity/rotations.h"
#include "tests/support/catch.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/random.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

const Material kTissue{7e3, 0.4, 1000};

template <class Law>
double energy(const Mat3& F) {
  const Moduli moduli = Law::moduli(kTissue);
  const auto law = law_at<Law>(moduli, F, nearest_rotation(F));
  return law.shape_energy() + 0.5 * moduli.lambda * law.dilation() * law.dilation();
}
template <class Law>
Mat3 stress(const Mat3& F) {
  const Moduli moduli = Law::moduli(kTissue);
  const auto law = law_at<Law>(moduli, F, nearest_rotation(F));
  return law.shape_stress() + moduli.lambda * law.dilation() * law.dilation_gradient();
}
/// Second derivative of the energy along a g_i^T and b g_j^T is a . B b.
template <class Law>
Mat3 block(const Mat3& F, const Vec3& gi, const Vec3& gj) {
  const Moduli moduli = Law::moduli(kTissue);
  auto law = law_at<Law>(moduli, F, nearest_rotation(F));
  law.prepare_blocks();
  const Mat3 dilation = law.dilation_gradient();
  return law.block(moduli.lambda * law.dilation(), gi, gj) +
         moduli.lambda * (dilation * gi) * (dilation * gj).transpose();
}

Mat3 random_deformation(test::Random& random, double size) {
  Mat3 F = Mat3::Identity();
  for (int c = 0; c < 3; ++c) F.col(c) += random.vector(size);
  return F;
}
Mat3 random_rotation(test::Random& random) {
  return Eigen::AngleAxisd(random.between(0.2, 3), random.vector(1).normalized()).toRotationMatrix();
}

template <class Law>
void check_derivatives(double size) {
  test::Random random(11);
  for (int round = 0; round < 20; ++round) {
    const Mat3 F = random_deformation(random, size);
    if (F.determinant() < 0.2) continue;
    const double h = 1e-6, scale = kTissue.young_modulus;
    Mat3 by_differences;
    for (int i = 0; i < 9; ++i) {
      Mat3 step = Mat3::Zero();
      step(i) = h;
      by_differences(i) = (energy<Law>(F + step) - energy<Law>(F - step)) / (2 * h);
    }
    CHECK((stress<Law>(F) - by_differences).norm() < 1e-7 * scale);
    const Vec3 gi = random.vector(1), gj = random.vector(1);
    Mat3 turned;
    for (int b = 0; b < 3; ++b) {
      const Mat3 step = h * Vec3::Unit(b) * gj.transpose();
      turned.col(b) = (stress<Law>(F + step) - stress<Law>(F - step)) * gi / (2 * h);
    }
    CHECK((block<Law>(F, gi, gj) - turned).norm() < 1e-6 * scale);
  }
}

template <class Law>
void check_rest() {
  test::Random random(12);
  CHECK(std::abs(energy<Law>(Mat3::Identity())) < 1e-12 * kTissue.young_modulus);
  CHECK(stress<Law>(Mat3::Identity()).norm() < 1e-12 * kTissue.young_modulus);
  for (int round = 0; round < 5; ++round) {
    const Vec3 gi = random.vector(1), gj = random.vector(1);
    CHECK((block<Law>(Mat3::Identity(), gi, gj) - block<LinearLaw>(Mat3::Identity(), gi, gj)).norm() <
          1e-12 * kTissue.young_modulus);
  }
}

template <class Law>
void check_turning() {
  test::Random random(13);
  for (int round = 0; round < 10; ++round) {
    const Mat3 F = random_deformation(random, 0.3), Q = random_rotation(random);
    CHECK(std::abs(energy<Law>(Q * F) - energy<Law>(F)) < 1e-10 * kTissue.young_modulus);
    CHECK((stress<Law>(Q * F) - Q * stress<Law>(F)).norm() < 1e-10 * kTissue.young_modulus);
  }
}

}  // namespace

TEST_CASE("laws: stress and its derivative are those of the energy") {
  check_derivatives<LinearLaw>(0.4);
  check_derivatives<CorotationalLaw>(0.4);
  check_derivatives<StVenantKirchhoffLaw>(0.4);
  check_derivatives<NeoHookeanLaw>(0.4);
}

TEST_CASE("laws: at rest no stress, and linear elasticity to first order") {
  check_rest<CorotationalLaw>();
  check_rest<StVenantKirchhoffLaw>();
  check_rest<NeoHookeanLaw>();
}

TEST_CASE("laws: what turns as a whole is not strained by it, but for the linear law") {
  check_turning<CorotationalLaw>();
  check_turning<StVenantKirchhoffLaw>();
  check_turning<NeoHookeanLaw>();
  test::Random random(14);
  CHECK(energy<LinearLaw>(random_rotation(random)) > 1);
}

TEST_CASE("laws: a stretch of Saint Venant and Kirchhoff, and of the corotational law, by hand") {
  // Along one axis by s, held aside: E = (s^2 - 1) / 2 and P = s (lambda + 2 mu) E; corotational (lambda + 2
  // mu) (s - 1).
  const double s = 1.3, m = kTissue.lame_lambda() + 2 * kTissue.lame_mu();
  const Mat3 F = Vec3(s, 1, 1).asDiagonal();
  CHECK(stress<StVenantKirchhoffLaw>(F)(0, 0) == Approx(s * m * (s * s - 1) / 2).epsilon(1e-12));
  CHECK(stress<CorotationalLaw>(F)(0, 0) == Approx(m * (s - 1)).epsilon(1e-12));
}

TEST_CASE("laws: the stable neo-Hookean energy of equation 14, written out") {
  const Mat3 F = (Mat3() << 1.1, 0.2, 0, -0.1, 0.9, 0.3, 0.05, 0, 1.2).finished();
  const double m = 4.0 / 3 * kTissue.lame_mu(), l = kTissue.lame_lambda() + 5.0 / 6 * kTissue.lame_mu();
  const double alpha = 1 + 0.75 * m / l, i = (F.transpose() * F).trace(), j = F.determinant();
  const auto psi = [&](double ic, double vol) {
    return 0.5 * m * (ic - 3) + 0.5 * l * (vol - alpha) * (vol - alpha) - 0.5 * m * std::log(ic + 1);
  };
  CHECK(energy<NeoHookeanLaw>(F) == Approx(psi(i, j) - psi(3, 1)).epsilon(1e-10));
}

TEST_CASE("laws: the nearest rotation, also of what is flat or turned inside out") {
  test::Random random(15);
  for (int round = 0; round < 200; ++round) {
    Mat3 F = random_deformation(random, round % 2 == 0 ? 0.5 : 2.0);
    if (round % 5 == 0) F.col(0) *= 1e-6;
    if (round % 7 == 0) F.col(1) *= -1;
    const Mat3 R = nearest_rotation(F);
    CHECK((R.transpose() * R - Mat3::Identity()).norm() < 1e-12);
    CHECK(R.determinant() == Approx(1).epsilon(1e-12));
    // No other rotation is nearer: |F - Q| is least where tr(Q^T F) is largest, which by singular values is
    // the sum of them, the least one negative where F is turned inside out.
    const Vec3 s = test::singular_values(F);
    const double most = s[0] + s[1] + (F.determinant() < 0 ? -s[2] : s[2]);
    CHECK((R.transpose() * F).trace() == Approx(most).epsilon(1e-9));
  }
  CHECK(nearest_rotation(Mat3::Zero()).allFinite());
}

TEST_CASE("laws: the nearest rotations of many together are those of each alone, bit by bit") {
  test::Random random(16);
  for (const std::size_t count : {1, 2, 3, 4, 5, 11, 64}) {
    std::vector<Mat3> F(count), R(count);
    for (std::size_t i = 0; i < count; ++i) {
      F[i] = random_deformation(random, i % 3 == 0 ? 2.0 : 0.01);
      if (i % 4 == 1) F[i].col(2) *= -1e-5;
    }
    nearest_rotations(F, R);
    for (std::size_t i = 0; i < count; ++i) CHECK(R[i] == nearest_rotation(F[i]));
  }
}

TEST_CASE("laws: inside out and flat, all but the linear one stay finite and push back") {
  const Mat3 inverted = Vec3(-0.3, 1, 1).asDiagonal();
  CHECK(stress<CorotationalLaw>(inverted)(0, 0) < 0);
  CHECK(stress<NeoHookeanLaw>(inverted)(0, 0) < 0);
  for (const double s : {-1.0, 0.0, 1e-9}) {
    const Mat3 F = Vec3(s, 1, 1).asDiagonal();
    CHECK(block<CorotationalLaw>(F, Vec3(1, 2, 3), Vec3(0.3, -1, 2)).allFinite());
    CHECK(block<NeoHookeanLaw>(F, Vec3(1, 2, 3), Vec3(0.3, -1, 2)).allFinite());
  }
}

TEST_CASE("laws: fibres add their modulus along them and nothing across, derivatives") {
  test::Random random(16);
  const Vec3 a = Vec3(1, 2, -1).normalized();
  const double k = 5e3;
  for (const bool small : {true, false}) {
    const Mat3 F = random_deformation(random, 0.3);
    const auto energy_at = [&](const Mat3& x) { return FibreLaw(k, a, x, small).energy(); };
    const auto stress_at = [&](const Mat3& x) { return FibreLaw(k, a, x, small).stress(); };
    const double h = 1e-6;
    for (int i = 0; i < 9; ++i) {
      Mat3 step = Mat3::Zero();
      step(i) = h;
      CHECK(std::abs(stress_at(F)(i) - (energy_at(F + step) - energy_at(F - step)) / (2 * h)) < 1e-6 * k);
    }
    const Vec3 gi = random.vector(1), gj = random.vector(1);
    for (int b = 0; b < 3; ++b) {
      const Mat3 step = h * Vec3::Unit(b) * gj.transpose();
      const Vec3 column = (stress_at(F + step) - stress_at(F - step)) * gi / (2 * h);
      CHECK((FibreLaw(k, a, F, small).block(gi, gj).col(b) - column).norm() < 1e-6 * k);
    }
    const Vec3 b = a.unitOrthogonal();
    CHECK(std::abs(energy_at(Mat3::Identity() + 0.1 * b * b.transpose())) < 1e-20);
    CHECK(energy_at(Mat3::Identity() + 0.1 * a * a.transpose()) == Approx(0.5 * k * 0.01).epsilon(1e-12));
  }
}
