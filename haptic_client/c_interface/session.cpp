#include <algorithm>
#include <csignal>
#include <thread>

#include "common/clock.h"
#include "common/realtime.h"
#include "common/text.h"
#include "haptic_client/extrapolation/extrapolators.h"
#include "haptic_client/pipeline/pipeline.h"
#include "haptic_client/session/server_access.h"
#include "protocol/c_interface/border.h"
#include "protocol/c_interface/c_messages.h"

using namespace palpate;
using namespace palpate::client;

namespace {

constexpr Time kPollPeriod = std::chrono::milliseconds(10);  // for a Welcome

static_assert(PALPATE_NOT_FINITE == static_cast<int>(Fault::kNotFinite) &&
              PALPATE_STORM == static_cast<int>(Fault::kStorm) &&
              PALPATE_WILD == static_cast<int>(Fault::kExcessive));

/// The client file, with what the caller says over it.
ClientConfig config_of(const palpate_session_options* options) {
  if (options == nullptr) return {};
  c_interface::require_complete(options, "options");
  ClientConfig config;
  if (options->client_file != nullptr) config = read_client_config(options->client_file);
  if (options->server != nullptr) {
    config.server = options->server;
    config.server_where = "server";
  }
  if (options->key_file != nullptr) config.key = options->key_file;
  config.insecure = options->insecure != 0;
  if (options->method != nullptr) {
    config.method = options->method;
    config.method_where = "method";
  }
  if (!(options->max_force >= 0)) fail("max_force: expected 0 N or more, not {}", options->max_force);
  if (options->max_force > 0) config.limits.max_force = std::min(config.limits.max_force, options->max_force);
  return config;
}

/// While it lives, new threads get no signals: those of a program are for its own threads.
class SignalsBlocked {
 public:
  SignalsBlocked() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~SignalsBlocked() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsBlocked(const SignalsBlocked&) = delete;
  SignalsBlocked& operator=(const SignalsBlocked&) = delete;

 private:
  sigset_t before_;
};

void write(const Vec3& from, double (&to)[3]) noexcept {
  std::copy(from.data(), from.data() + 3, to);
}

}  // namespace

/// The tool of a session without a device and a loop, which are the caller's.
struct palpate_session {
  explicit palpate_session(const ClientConfig& config);
  ~palpate_session();

  /// Throws when no server gives a tool in time.
  void connect();
  void tick(const palpate_tool_state& published, palpate_rendered& rendered) noexcept;

  std::atomic<bool> rearm{false};

 private:
  protocol::ToolState sense(const palpate_tool_state& published) noexcept;
  void report(const TickResult& result, palpate_rendered& rendered) const noexcept;

  ClientConfig config_;
  Pipeline pipeline_;
  HapticMailboxes mailboxes_;
  Arrivals arrivals_;             // of one tick
  protocol::ForceSample newest_;  // that the law used; number 0: none
  protocol::UdpSocket socket_;
  NetLink link_;
  std::jthread net_thread_;
};

palpate_session::palpate_session(const ClientConfig& config)
    : config_(config),
      pipeline_(find_row(extrapolators(), config.method, "method", config.method_where).make(),
                config.workspace, config.limits, config.passivity, config.blend),
      socket_(protocol::Endpoint{.v6 = server_of(config).v6}),
      link_(socket_, server_of(config), mailboxes_, key_of(config), nullptr) {
  pipeline_.set_request({.at_tool = true});
}

palpate_session::~palpate_session() {
  if (net_thread_.joinable()) link_.stop();
}

void palpate_session::connect() {
  {
    const SignalsBlocked blocked;
    net_thread_ = std::jthread([this] {
      take_role(ThreadRole::kNetwork);
      try {
        link_.run();
      } catch (...) {  // nothing comes any more, so the force fades
      }
    });
  }
  for (const Time start = now(); !link_.welcomed; sleep_until(now() + kPollPeriod)) {
    if (now() - start > kWelcomePatience) fail_unanswered(link_, config_, "", kWelcomePatience);
  }
}

/// Senses as the pipeline senses a device, but that a caller may know the velocity.
protocol::ToolState palpate_session::sense(const palpate_tool_state& published) noexcept {
  const Workspace& workspace = config_.workspace;
  const auto state = c_interface::read_tool_state(published);
  const bool valid = state && (state->flags & protocol::ToolState::kDeviceLost) == 0;
  DeviceReading reading{.t = now(), .buttons = static_cast<std::uint16_t>(published.buttons), .valid = valid};
  if (valid) {  // the caller's frame is that of the device
    reading.p_D = state->p_W;
    reading.q_D = Quat(state->q_W[0], state->q_W[1], state->q_W[2], state->q_W[3]);
  }
  protocol::ToolState tool = pipeline_.sense(reading);
  if (!valid) return tool;
  const bool clutched = (tool.flags & protocol::ToolState::kClutched) != 0;  // then the tool stays
  if ((published.flags & PALPATE_HAS_VELOCITY) != 0 && !clutched)
    tool.v_W = workspace.scale * workspace.axes * state->v_W;
  return tool;
}

void palpate_session::tick(const palpate_tool_state& published, palpate_rendered& rendered) noexcept {
  if (rearm.exchange(false, std::memory_order_relaxed)) pipeline_.rearm();
  const protocol::ToolState tool = sense(published);
  arrivals_.take(mailboxes_, pipeline_);
  const TickResult result = pipeline_.render(tool, arrivals_.sample(), arrivals_.pages());
  if (result.used) newest_ = *arrivals_.sample();
  mailboxes_.tool.push(result.tool);
  mailboxes_.bell.ring();
  report(result, rendered);
}

void palpate_session::report(const TickResult& result, palpate_rendered& rendered) const noexcept {
  const Workspace& workspace = config_.workspace;
  const Time age{pipeline_.age_ns()};
  const bool known = age >= Time::zero();
  rendered.state = !known ? PALPATE_WAITING : age <= kOutage ? PALPATE_LIVE : PALPATE_SILENT;
  rendered.fault = static_cast<std::uint32_t>(pipeline_.limiter().fault());
  rendered.flags = newest_.flags & (PALPATE_IN_CONTACT | PALPATE_FLAGGED | PALPATE_HAS_TANGENT);
  rendered.tick = result.tool.tick;
  rendered.sample = newest_.number;
  write(result.f_D, rendered.force);
  rendered.law_newton = pipeline_.law_newton();
  rendered.gain = pipeline_.passivity().gain();
  rendered.age = known ? to_seconds(age) : -1;
  write(workspace.axes.transpose() * newest_.at_tool.normal_W, rendered.normal);
  rendered.gap = newest_.at_tool.gap / workspace.scale;
}

int palpate_session_open(const palpate_session_options* options, palpate_session** session, char* error,
                         std::size_t error_size) {
  if (session != nullptr) *session = nullptr;
  return c_interface::guarded(error, error_size, [&] {
    if (session == nullptr) fail("palpate_session_open: session is NULL");
    auto made = std::make_unique<palpate_session>(config_of(options));
    made->connect();
    *session = made.release();
  });
}

int palpate_session_tick(palpate_session* session, const palpate_tool_state* tool,
                         palpate_rendered* rendered) {
  if (session == nullptr || !c_interface::is_complete(tool) || !c_interface::is_complete(rendered))
    return PALPATE_WRONG_INPUT;
  session->tick(*tool, *rendered);
  return PALPATE_OK;
}

int palpate_session_rearm(palpate_session* session) {
  if (session == nullptr) return PALPATE_WRONG_INPUT;
  session->rearm.store(true, std::memory_order_relaxed);
  return PALPATE_OK;
}

void palpate_session_close(palpate_session* session) {
  delete session;
}
