#include "haptic_client/extrapolation/tangent.h"

#include <Eigen/Eigenvalues>

#include "common/units.h"

namespace palpate::client {

Mat3 restoring_part(const Mat3& k) noexcept {
  const Mat3 symmetric = 0.5 * (k + k.transpose());
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  solver.compute(symmetric);
  if (solver.info() != Eigen::Success) return Mat3::Zero();
  const Mat3& v = solver.eigenvectors();
  const Mat3 part = v * solver.eigenvalues().cwiseMin(0).asDiagonal() * v.transpose();
  return part.allFinite() ? part : Mat3(Mat3::Zero());
}

Vec3 force_at(const Linearisation& l, const Vec3& p) noexcept {
  const Vec3 x = p - l.p_W;
  if (!(x.cwiseAbs().maxCoeff() < kMaxCoordinate)) return l.f_W;
  if (l.f_W.isZero(0)) {
    const double depth = l.gap + l.normal_W.dot(x);
    return depth < 0 ? Vec3(depth * (l.tangent * l.normal_W)) : Vec3(Vec3::Zero());
  }
  return without_pull(l.f_W + l.tangent * x, l.f_W);
}

void Tangent::update(const Sample& sample) noexcept {
  learned_.update(sample);
  if (!usable(sample) || (newest_.number > 0 && sample.t <= newest_.t)) return;
  newest_ = with_usable_parts(sample);
  motion_.update(newest_);
  if (newest_.at_tool) newest_.at_tool->tangent = restoring_part(newest_.at_tool->tangent);
}

void Tangent::restart() noexcept {
  learned_.restart();
  newest_ = {};
  motion_.restart();
}

Vec3 Tangent::force(const Vec3& p, Time t) noexcept {
  if (!newest_.at_tool) return learned_.force(p, t);
  return force_at(*newest_.at_tool, p - motion_.since_sample(t));
}

}  // namespace palpate::client
