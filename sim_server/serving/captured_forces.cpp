#include "sim_server/serving/captured_forces.h"

#include <algorithm>
#include <functional>
#include <map>

#include "common/error.h"
#include "common/log.h"
#include "protocol/capture.h"
#include "protocol/codec.h"
#include "protocol/scene_print.h"

namespace palpate::sim {
using namespace protocol;

namespace {

constexpr std::size_t kMostSessions = 1000;  // of a capture: noise must not fill the memory
constexpr double kFastest = 1e6;             // Hz: what a Welcome may say

struct Session {
  std::map<std::uint64_t, ForceSample> samples;  // by number; what the capture holds twice counts once
  double tool_radius = 0;
  std::optional<ScenePrint> scene;
};

/// Without what is not in order of time: it would be played late.
CapturedForces in_order(const Session& session) {
  CapturedForces forces;
  forces.scene = session.scene;
  if (session.tool_radius > 0) forces.tool_radius = session.tool_radius;
  for (const auto& [number, sample] : session.samples) {
    if (forces.samples.empty() || sample.tool_t_ns > forces.samples.back().tool_t_ns)
      forces.samples.push_back(sample);
  }
  forces.tool = forces.samples.front().tool;
  return forces;
}

}  // namespace

double CapturedForces::seconds() const {
  if (samples.empty()) return 0;
  return 1e-9 * static_cast<double>(samples.back().tool_t_ns - samples.front().tool_t_ns);
}

double CapturedForces::rate_hz() const {
  return samples.size() < 2 ? 0 : static_cast<double>(samples.size() - 1) / seconds();
}

std::vector<CapturedForces> read_captured_forces(const std::filesystem::path& capture) {
  CaptureReader reader(capture);
  std::map<std::uint64_t, Session> sessions;
  CapturedDatagram captured;
  Datagram datagram;
  while (reader.next(captured)) {
    if (decode(captured.bytes, datagram) != Verdict::kAccepted) continue;
    if (sessions.size() >= kMostSessions && !sessions.contains(datagram.header.session)) continue;
    if (const auto* sample = std::get_if<ForceSample>(&datagram.message))
      sessions[datagram.header.session].samples.emplace(sample->number, *sample);
    if (const auto* welcome = std::get_if<Welcome>(&datagram.message)) {
      Session& session = sessions[datagram.header.session];
      if (session.tool_radius > 0) continue;  // it comes again in mid-session; another one is forged
      session.tool_radius = welcome->tool_radius;
      session.scene = print_in(*welcome);
    }
  }
  if (const std::string trouble = reader.trouble(); !trouble.empty())
    log::warning("{}: {}", capture.string(), trouble);
  std::vector<CapturedForces> all;
  for (const auto& [number, session] : sessions) {
    if (!session.samples.empty()) all.push_back(in_order(session));
  }
  std::ranges::stable_sort(all, std::greater(), [](const CapturedForces& f) { return f.samples.size(); });
  if (all.empty() || all.front().samples.size() < 2)
    fail("{}: holds no force samples of Palpate, so there is nothing to play", capture.string());
  if (const double rate = all.front().rate_hz(); !(rate > 0 && rate <= kFastest))
    fail("{}: its force samples come at {:.3g} Hz by their times; at most {:g} Hz can be played",
         capture.string(), rate, kFastest);
  return all;
}

}  // namespace palpate::sim
