#pragma once
#include "common/types.h"
#include "sim_server/elasticity/material.h"

namespace palpate::sim {

/// Elastic laws at one deformation gradient F (3 x 3, F = I at rest), all in the same two parts,
///   Psi(F) = w(F) + lambda / 2 theta(F)^2,
/// w (Pa) the energy of a change of shape, theta (no unit) a measure of the change of volume that is the
/// trace of the strain at small strain; so an element may average theta over its neighbours and stay
/// conservative. Each gives
///   shape_energy  w,                      Pa
///   shape_stress  dw/dF,                  Pa, first Piola-Kirchhoff
///   dilation      theta
///   dilation_gradient  dtheta/dF
///   prepare_blocks()   before the first block: what forces alone do not need
///   block(p, a, b)     the matrix B with a' B b = (d2w + p d2theta)(a' x g_i, b' x g_j): what two shape
///                      functions of gradients g_i, g_j (1/m) get from the second derivatives, Pa/m^2,
/// and all agree with linear elasticity of the same Lame parameters at rest. Pure; no allocation. Made by
/// `law_at`.
struct Moduli {
  double mu, lambda;  ///< Pa: of w and of theta, as the law counts them
};

/// Small strain: w = mu |sym(F) - I|^2, theta = tr(F) - 3. Not for large turns.
class LinearLaw {
 public:
  static constexpr bool kTurns = false;
  static Moduli moduli(const Material& m) { return {m.lame_mu(), m.lame_lambda()}; }
  LinearLaw(const Moduli& moduli, const Mat3& F) noexcept
      : mu_(moduli.mu), strain_(0.5 * (F + F.transpose()) - Mat3::Identity()) {}
  double shape_energy() const noexcept { return mu_ * strain_.squaredNorm(); }
  Mat3 shape_stress() const noexcept { return 2 * mu_ * strain_; }
  double dilation() const noexcept { return strain_.trace(); }
  Mat3 dilation_gradient() const noexcept { return Mat3::Identity(); }
  void prepare_blocks() noexcept {}
  Mat3 block(double, const Vec3& gi, const Vec3& gj) const noexcept {
    Mat3 block = mu_ * gj * gi.transpose();
    block.diagonal().array() += mu_ * gi.dot(gj);
    return block;
  }

 private:
  double mu_;
  Mat3 strain_;
};

/// Linear in the stretch S of F = R S: w = mu |S - I|^2, theta = tr S - 3. With the exact derivative of R
/// (Chao, Pinkall, Sanan and Schroeder 2010, ACM TOG 29:38, section 3). Where two stretches cancel (inside
/// out), R has no derivative, and the one of a small stretch stands in.
class CorotationalLaw {
 public:
  static constexpr bool kTurns = true;
  static Moduli moduli(const Material& m) { return {m.lame_mu(), m.lame_lambda()}; }
  CorotationalLaw(const Moduli& moduli, const Mat3& F, const Mat3& R) noexcept
      : mu_(moduli.mu), trace_(F.cwiseProduct(R).sum()), F_(F), R_(R) {}
  double shape_energy() const noexcept { return mu_ * (F_ - R_).squaredNorm(); }
  Mat3 shape_stress() const noexcept { return 2 * mu_ * (F_ - R_); }
  double dilation() const noexcept { return trace_ - 3; }
  const Mat3& dilation_gradient() const noexcept { return R_; }
  void prepare_blocks() noexcept;
  Mat3 block(double p, const Vec3& gi, const Vec3& gj) const noexcept;

 private:
  double mu_, trace_;  // trace of S
  Mat3 F_, R_, turn_;  // turn: R (tr(S) I - S)^-1 R^T
};

/// Saint Venant and Kirchhoff: w = mu |E|^2, theta = tr E, E = (F^T F - I) / 2. Softens under compression:
/// not below about 0.6 of its length.
class StVenantKirchhoffLaw {
 public:
  static constexpr bool kTurns = false;
  static Moduli moduli(const Material& m) { return {m.lame_mu(), m.lame_lambda()}; }
  StVenantKirchhoffLaw(const Moduli& moduli, const Mat3& F) noexcept
      : mu_(moduli.mu), F_(F), strain_(0.5 * (F.transpose() * F - Mat3::Identity())) {}
  double shape_energy() const noexcept { return mu_ * strain_.squaredNorm(); }
  Mat3 shape_stress() const noexcept { return 2 * mu_ * F_ * strain_; }
  double dilation() const noexcept { return strain_.trace(); }
  const Mat3& dilation_gradient() const noexcept { return F_; }
  void prepare_blocks() noexcept {}
  Mat3 block(double p, const Vec3& gi, const Vec3& gj) const noexcept;

 private:
  double mu_;
  Mat3 F_, strain_;
};

/// Neo-Hookean in the stable form of Smith, de Goes and Kim (2018, ACM TOG 37:12, equations 14 and 16), which
/// has an answer for flat and inverted elements too:
///   Psi = m/2 (I_C - 3) + l/2 (J - alpha)^2 - m/2 log(I_C + 1),   alpha = 1 + 3 m / (4 l),
/// J = det F, I_C = |F|^2, m = 4/3 mu, l = lambda + 5/6 mu; but for a constant, w = m/2 (I_C - 3 - log((I_C +
/// 1) / 4)) - 3/4 m (J - 1) and theta = J - 1.
class NeoHookeanLaw {
 public:
  static constexpr bool kTurns = false;
  static Moduli moduli(const Material& m) {
    return {4.0 / 3 * m.lame_mu(), m.lame_lambda() + 5.0 / 6 * m.lame_mu()};
  }
  NeoHookeanLaw(const Moduli& moduli, const Mat3& F) noexcept;
  double shape_energy() const noexcept;
  Mat3 shape_stress() const noexcept { return mu_ * (1 - 1 / (stretch2_ + 1)) * F_ - 0.75 * mu_ * cofactor_; }
  double dilation() const noexcept { return volume_ - 1; }
  const Mat3& dilation_gradient() const noexcept { return cofactor_; }
  void prepare_blocks() noexcept {}
  Mat3 block(double p, const Vec3& gi, const Vec3& gj) const noexcept;

 private:
  double mu_, stretch2_, volume_;  // I_C, J
  Mat3 F_, cofactor_;
};

/// The law at `F`; `R` (`nearest_rotation` of it) is read where the law `kTurns`.
template <class Law>
Law law_at(const Moduli& moduli, const Mat3& F, const Mat3& R) noexcept {
  if constexpr (Law::kTurns) return Law(moduli, F, R);
  if constexpr (!Law::kTurns) return Law(moduli, F);
}

/// Fibres along the unit vector `a` at rest, which add k / 2 (|F a| - 1)^2 to any law (and k / 2 (a . F a -
/// 1)^2 to the linear one): transverse isotropy, whose Young modulus along `a` is that of the law plus k
/// where nothing holds it aside.
class FibreLaw {
 public:
  FibreLaw(double modulus, const Vec3& a, const Mat3& F, bool small_strain) noexcept;
  double energy() const noexcept { return 0.5 * k_ * stretch_ * stretch_; }
  Mat3 stress() const noexcept { return k_ * stretch_ * along_ * a_.transpose(); }
  Mat3 block(const Vec3& gi, const Vec3& gj) const noexcept;

 private:
  double k_, stretch_ = 0, across_ = 0;  // across: what turning the fibre gives
  Vec3 a_, along_;                       // along: F a / |F a|
};

}  // namespace palpate::sim
