#include "haptic_client/extrapolation/best_recent.h"

#include <algorithm>
#include <limits>

namespace palpate::client {
namespace {
constexpr double kSamples = 32;  // that the mean error is of
constexpr double kBetter = 0.8;  // of the error of the rendered law
constexpr double kLead = 1.03;   // of the largest force lately: what a law may predict where the tool cuts
}  // namespace

BestRecent::BestRecent(std::vector<Law> laws) : laws_(std::move(laws)), chosen_(laws_.size() - 1) {
  for (const Law& law : laws_) {
    const Request request = law.law->request();
    sees_surface_.push_back(request.at_tool || request.ahead || request.surface ? 1 : 0);
  }
}

void BestRecent::update(const Sample& sample) noexcept {
  if (usable(sample)) {
    if (const Forces* const given = ticks_.at(sample.t)) judge(*given, sample.f);
    free_ = sample.f.isZero(0);
    cutting_ = sample.cutting;
    sizes_[samples_++ % kAfterCut] = sample.f.norm();
  }
  for (Law& law : laws_) law.law->update(sample);
}

void BestRecent::judge(const Forces& given, const Vec3& right) noexcept {
  const auto pushes = [&](std::size_t i) { return !given[i].isZero(0); };
  bool any = !right.isZero(0);
  for (std::size_t i = 0; i < laws_.size(); ++i) any = any || pushes(i);
  if (!any) return;
  judged_ = std::min(judged_ + 1, kSamples);
  std::size_t best = laws_.size() - 1;
  for (std::size_t i = laws_.size(); i-- > 0;) {
    error_[i] += ((given[i] - right).norm() - error_[i]) / judged_;
    if (error_[i] < error_[best]) best = i;
  }
  if (error_[best] < (after_cut() ? 1 : kBetter) * error_[chosen_]) chosen_ = best;
}

void BestRecent::restart() noexcept {
  for (Law& law : laws_) law.law->restart();
  error_ = {};
  judged_ = 0;
  chosen_ = laws_.size() - 1;
  free_ = true;
  cutting_ = false;
  sizes_ = {};
  samples_ = cut_at_ = 0;
  ticks_.forget();
}

/// Keeps the law that is best. Laws are judged by what they gave until then, too, which was rendered as
/// tissue went.
void BestRecent::surface_cut() noexcept {
  cut_at_ = samples_ + 1;
  for (Law& law : laws_) law.law->surface_cut();
}

void BestRecent::start_tick(Time now) noexcept {
  now_ = now;
  for (Law& law : laws_) law.law->start_tick(now);
}

Vec3 BestRecent::force(const Vec3& p, Time t) noexcept {
  Forces given{};
  double most = std::numeric_limits<double>::infinity();
  if (cutting_ || after_cut()) most = (cutting_ ? kLead : 1) * *std::ranges::max_element(sizes_);
  for (std::size_t i = 0; i < laws_.size(); ++i) {
    // A law that looks back alone would go on pulling where the tool is free.
    const bool none = free_ && sees_surface_[i] == 0;
    given[i] = none ? Vec3(Vec3::Zero()) : laws_[i].law->force(p, t);
    const double size = given[i].norm();
    if (size > most) given[i] *= most / size;
  }
  if (Forces* const tick = ticks_.add(std::max(now_, t))) *tick = given;
  return given[chosen_];
}

Request BestRecent::request() const noexcept {
  Request all;
  for (const Law& law : laws_) all |= law.law->request();
  return all;
}

std::string_view BestRecent::substitute() const noexcept {
  const std::string_view inner = laws_[chosen_].law->substitute();
  return inner.empty() ? laws_[chosen_].name : inner;
}

}  // namespace palpate::client
