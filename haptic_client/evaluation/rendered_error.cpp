#include "haptic_client/evaluation/rendered_error.h"

namespace palpate::client {

void RenderedError::add(const RenderedForce& rendered, const ReferenceForce& right, bool outage) noexcept {
  table_.add(rendered.written, right);
  (outage ? outages_ : extrapolation_) += (rendered.law - right.f).norm();
  fades_ += (rendered.faded - rendered.law).norm();
  limits_ += (rendered.written - rendered.faded).norm();
  error_ += (rendered.written - right.f).norm();
  ++judged_;
}

RenderedErrorParts RenderedError::parts() const noexcept {
  RenderedErrorParts parts{.hand = table_.metrics()};
  const double newton = error_ > 0 ? parts.hand.mean_percent / error_ : 0;  // % of a sum
  parts.extrapolation_percent = newton * extrapolation_;
  parts.outages_percent = newton * outages_;
  parts.fades_percent = newton * fades_;
  parts.limits_percent = newton * limits_;
  return parts;
}

}  // namespace palpate::client
