#include "sim_server/solvers/time_stepping.h"

#include <utility>

namespace palpate::sim {

TimeStepping::TimeStepping(std::span<const Vec3> x, bool second_order)
    : second_order_(second_order),
      x_(x.begin(), x.end()),
      v_(x.size(), Vec3::Zero()),
      f_(v_),
      earlier_x_(x_),
      earlier_v_(v_),
      earlier_f_(f_),
      predictor_x_(x_),
      predictor_v_(v_),
      predictor_f_(f_) {}

void TimeStepping::restart(std::span<const Vec3> x, std::span<const Vec3> v, std::span<const Vec3> internal) {
  x_.assign(x.begin(), x.end());
  earlier_x_ = x_;
  if (!v.empty()) v_.assign(v.begin(), v.end());
  earlier_v_ = v_;
  f_.assign(internal.begin(), internal.end());
  earlier_f_ = f_;
}

void TimeStepping::begin(double h) {
  h_ = h;
  const bool second = second_order_ && steps_ > 0;
  c_ = (second ? 1.5 : 1) / h;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    predictor_x_[i] = second ? Vec3((4 * x_[i] - earlier_x_[i]) / 3) : x_[i];
    predictor_v_[i] = second ? Vec3((4 * v_[i] - earlier_v_[i]) / 3) : v_[i];
    predictor_f_[i] = second ? Vec3((4 * f_[i] - earlier_f_[i]) / 3) : f_[i];
  }
}

void TimeStepping::end(std::span<const Vec3> x, std::vector<Vec3>& internal, bool stop) {
  std::swap(earlier_f_, f_);
  std::swap(f_, internal);
  if (stop) std::ranges::copy(f_, earlier_f_.begin());
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const Vec3 v = stop ? Vec3(Vec3::Zero()) : velocity_at(i, x[i]);
    earlier_x_[i] = stop ? x[i] : x_[i];
    earlier_v_[i] = stop ? v : v_[i];
    x_[i] = x[i];
    v_[i] = v;
  }
  ++steps_;
}

}  // namespace palpate::sim
