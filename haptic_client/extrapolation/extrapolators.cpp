#include "haptic_client/extrapolation/extrapolators.h"

#include <array>

#include "haptic_client/extrapolation/best_recent.h"
#include "haptic_client/extrapolation/constant.h"
#include "haptic_client/extrapolation/interpolate_with_delay.h"
#include "haptic_client/extrapolation/kalman.h"
#include "haptic_client/extrapolation/learned_stiffness.h"
#include "haptic_client/extrapolation/linear_position.h"
#include "haptic_client/extrapolation/linear_time.h"
#include "haptic_client/extrapolation/local_contact.h"
#include "haptic_client/extrapolation/tangent.h"
#include "haptic_client/extrapolation/two_tangents.h"

namespace palpate::client {
namespace {

template <class Law, auto... Args>
std::unique_ptr<Extrapolator> make() {
  return std::make_unique<Law>(Args...);
}

using Ratio = LinearPosition::Ratio;

/// Those that have something of their own to say, the most informed last.
std::unique_ptr<Extrapolator> make_best_recent() {
  std::vector<BestRecent::Law> laws;
  laws.push_back({"constant", make<Constant>()});
  laws.push_back({"linear_time", make<LinearTime>()});
  laws.push_back({"linear_position_signed", make<LinearPosition, Ratio::kSigned>()});
  laws.push_back({"learned_stiffness", make<LearnedStiffness>()});
  laws.push_back({"tangent", make<Tangent>()});
  laws.push_back({"two_tangents", make<TwoTangents>()});
  laws.push_back({"local_contact", make<LocalContact>()});
  return std::make_unique<BestRecent>(std::move(laws));
}

constexpr std::array kExtrapolators{
    ExtrapolatorRow{"constant", "the newest force (the paper's first law)", &make<Constant>},
    ExtrapolatorRow{"linear_time", "linear in time (the paper's second law)", &make<LinearTime>},
    ExtrapolatorRow{"linear_position", "linear in position, as the paper prints it",
                    &make<LinearPosition, Ratio::kPrinted>},
    ExtrapolatorRow{"linear_position_signed", "linear in position, with the sign of the motion",
                    &make<LinearPosition, Ratio::kSigned>},
    ExtrapolatorRow{"learned_stiffness", "a symmetric stiffness learned from the samples",
                    &make<LearnedStiffness>},
    ExtrapolatorRow{"tangent", "the server's tangent stiffness, and its surface before contact",
                    &make<Tangent>},
    ExtrapolatorRow{"two_tangents", "tangents where the tool was and where it was expected",
                    &make<TwoTangents>},
    ExtrapolatorRow{"local_contact", "the contact solved here, on the server's model of the surface",
                    &make<LocalContact>},
    ExtrapolatorRow{"best_recent", "of constant to local_contact, the one whose recent predictions were best",
                    &make_best_recent, true, true},
    ExtrapolatorRow{"kalman", "a Kalman filter on the force (the paper turns it down)", &make<Kalman>, false},
    ExtrapolatorRow{"interpolate_with_delay",
                    "the line between samples, two periods late (the paper turns it down)",
                    &make<InterpolateWithDelay>, false},
};

}  // namespace

std::span<const ExtrapolatorRow> extrapolators() {
  return kExtrapolators;
}

}  // namespace palpate::client
