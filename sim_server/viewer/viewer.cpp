#include "sim_server/viewer/viewer.h"

#include <algorithm>
#include <cstring>
#include <libwebsockets.h>
#include <list>
#include <netinet/tcp.h>
#include <strings.h>
#include <sys/socket.h>

#include "common/clock.h"
#include "common/error.h"
#include "protocol/udp_socket.h"
#include "sim_server/viewer/connections.h"
#include "sim_server/viewer/page_files.h"
#include "sim_server/viewer/page_requests.h"
#include "sim_server/viewer/showing_maker.h"

namespace palpate::sim {
namespace {

constexpr const char* kLive = "palpate-view-1";
constexpr lws_usec_t kSearchEach = 50'000;  // us: for who is quiet, for states while nothing steps
constexpr std::size_t kChunk = 16384;       // of a file
constexpr int kUnsent = 32768;  // bytes waiting in the system, above which a page gets nothing new
// libwebsockets opens no more at once: room for those that are about to be closed.
constexpr unsigned kMostOpen = Connections::kMost + 16;
constexpr int kPatience = 10;  // s, with who fetches a file

std::string header_of(lws* wsi, lws_token_indexes which) {
  std::array<char, 512> text{};
  const int size = lws_hdr_copy(wsi, text.data(), static_cast<int>(text.size()), which);
  return size > 0 ? std::string(text.data(), static_cast<std::size_t>(size)) : std::string();
}

/// Returns the address of the other end, without its port.
std::string address_of(lws* wsi) {
  std::array<char, 64> text{};
  return lws_get_peer_simple(wsi, text.data(), text.size()) != nullptr ? text.data() : "";
}

/// Ends a connection, perhaps the one that is being served, after the callback.
void close_later(Connections::Id id) {
  lws_set_timeout(static_cast<lws*>(const_cast<void*>(id)), PENDING_TIMEOUT_USER_REASON_BASE,
                  LWS_TO_KILL_ASYNC);
}

bool is_websocket(const char* upgrade) {
  return upgrade != nullptr && strcasecmp(upgrade, "websocket") == 0;
}

/// The remainder of a file that is being sent.
struct Fetch {
  const char* next;
  std::size_t remaining;
};

}  // namespace

struct Viewer::Server {
  struct Page {
    lws* wsi;
    PageLink link;
    std::string coming;  // of a message that comes in parts
    struct End {
      lws_close_status why;
      std::string text;
    };
    std::optional<End> end{};  // it gets the reason, and is closed, when its connection takes that
  };
  struct Timer {
    lws_sorted_usec_list_t entry{};
    Server* server = nullptr;
  };

  Server(const ViewerAddress& where, std::string token_, const SceneFacts& scene_, ViewerFeed& feed_,
         const Bytes* session_);
  ~Server() {
    if (context != nullptr) lws_context_destroy(context);
  }
  static int on_event(lws* wsi, lws_callback_reasons reason, void* user, void* in, std::size_t size) noexcept;
  static void on_timer(lws_sorted_usec_list_t* entry) noexcept;
  void update();
  int on_request(lws* wsi, Fetch& fetch);
  int send_head(lws* wsi, unsigned status, const PageFile& file, const std::string& host, bool head_only,
                Fetch& fetch);
  int send_chunk(lws* wsi, Fetch& fetch);
  int complete(lws* wsi);
  bool may_connect(lws* wsi) const;
  void open(lws* wsi, Page*& page);
  void on_message(Page& page, std::string_view part);
  void end(Page& page, lws_close_status why, std::string text);
  int send_next(Page& page);

  ViewerAddress address;
  ViewerFeed& feed;
  PageRequests requests;
  const Bytes* session;
  ShowingMaker maker;
  std::array<lws_protocols, 3> protocols{};
  lws_retry_bo_t idle{};
  std::string listens_on;  // as libwebsockets wants it, which keeps a pointer to it
  lws_context* context = nullptr;
  std::atomic<bool> stops{false};
  Connections connections;
  std::list<Page> pages;
  Bytes sent, buffer;  // the newest message, and with room for its frame
  Timer timer;
};

Viewer::Server::Server(const ViewerAddress& where, std::string token_, const SceneFacts& scene_,
                       ViewerFeed& feed_, const Bytes* session_)
    : address(where),
      feed(feed_),
      requests{std::move(token_), scene_, feed_},
      session(session_),
      maker(scene_, feed_, !scene_.recorded) {
  require_free(address);
  lws_set_log_level(0, nullptr);
  protocols[0].name = "http";
  protocols[0].callback = &on_event;
  protocols[0].per_session_data_size = sizeof(Fetch);
  protocols[1].name = kLive;
  protocols[1].callback = &on_event;
  protocols[1].per_session_data_size = sizeof(Page*);  // NOLINT(bugprone-sizeof-expression): a pointer it is
  protocols[1].rx_buffer_size = kLongestPageMessage;
  idle.secs_since_valid_ping = 10;
  idle.secs_since_valid_hangup = 40;
  listens_on = protocol::to_string(address.endpoint);
  listens_on.resize(listens_on.rfind(':'));
  if (address.endpoint.v6) listens_on = listens_on.substr(1, listens_on.size() - 2);
  lws_context_creation_info info{};
  info.options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS | LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND |
                 LWS_SERVER_OPTION_DISABLE_OS_CA_CERTS;
  if (!address.endpoint.v6) info.options |= LWS_SERVER_OPTION_DISABLE_IPV6;
  info.iface = listens_on.c_str();
  info.port = address.endpoint.port;
  info.protocols = protocols.data();
  info.user = this;
  info.fd_limit_per_thread = kMostOpen;
  info.max_http_header_pool = kMostOpen;  // with fewer, silent connections keep others waiting
  info.timeout_secs = kPatience;
  info.keepalive_timeout = kPatience;
  info.retry_and_idle_policy = &idle;
  info.server_string = "palpate";
  context = lws_create_context(&info);
  if (context == nullptr) fail_at_run_time("--viewer: no memory or descriptor left for the live page");
  lws_vhost* const vhost = lws_create_vhost(context, &info);
  if (vhost == nullptr) {
    lws_context_destroy(context);
    fail("--viewer: cannot listen on {} (TCP)", protocol::to_string(address.endpoint));
  }
  address.endpoint.port = static_cast<std::uint16_t>(lws_get_vhost_listen_port(vhost));
  timer.server = this;
  lws_sul_schedule(context, 0, &timer.entry, &on_timer, kSearchEach);
}

int Viewer::Server::on_event(lws* wsi, lws_callback_reasons reason, void* user, void* in,
                             std::size_t size) noexcept try {
  auto* const server = static_cast<Server*>(lws_context_user(lws_get_context(wsi)));
  const lws_protocols* const protocol = lws_get_protocol(wsi);
  const bool live = protocol != nullptr && protocol == lws_vhost_name_to_protocol(lws_get_vhost(wsi), kLive);
  Page** const page = static_cast<Page**>(user);
  switch (reason) {
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
      if (live) server->update();
      return 0;
    case LWS_CALLBACK_SERVER_NEW_CLIENT_INSTANTIATED:
      if (const auto departing = server->connections.open(wsi, address_of(wsi), now()))
        close_later(*departing);
      return 0;
    case LWS_CALLBACK_WSI_DESTROY:
      server->connections.closed(wsi);
      return 0;
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
      // Of HTTP/2 the library makes streams that nothing here knows.
      return is_websocket(static_cast<const char*>(in)) ? 0 : -1;
    case LWS_CALLBACK_HTTP:
      server->connections.serve(wsi);
      return server->on_request(wsi, *static_cast<Fetch*>(user));
    case LWS_CALLBACK_HTTP_WRITEABLE:
      return server->send_chunk(wsi, *static_cast<Fetch*>(user));
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
      return live && server->may_connect(wsi) ? 0 : -1;
    case LWS_CALLBACK_ESTABLISHED:
      server->connections.serve(wsi);
      if (live) server->open(wsi, *page);
      return live ? 0 : -1;
    case LWS_CALLBACK_RECEIVE:
      if (!live || *page == nullptr) return -1;
      server->on_message(**page, {static_cast<const char*>(in), size});
      return 0;
    case LWS_CALLBACK_SERVER_WRITEABLE:
      return live && *page != nullptr ? server->send_next(**page) : -1;
    case LWS_CALLBACK_CLOSED:
      if (live && *page != nullptr) {
        for (const PagePointer& released : (*page)->link.released()) server->feed.hooks.point(released);
        server->pages.remove_if([&](const Page& other) { return &other == *page; });
        server->feed.pages = static_cast<int>(server->pages.size());
        *page = nullptr;
      }
      return 0;
    case LWS_CALLBACK_HTTP_BODY:
    case LWS_CALLBACK_HTTP_BODY_COMPLETION:
    case LWS_CALLBACK_HTTP_FILE_COMPLETION:
      return -1;
    default:
      return 0;
  }
} catch (...) {
  return -1;  // no memory for this page: it goes
}

void Viewer::Server::on_timer(lws_sorted_usec_list_t* entry) noexcept {
  Server* const server = reinterpret_cast<Timer*>(entry)->server;
  try {
    server->update();
  } catch (...) {  // no memory; perhaps next time
  }
  lws_sul_schedule(server->context, 0, entry, &on_timer, kSearchEach);
}

void Viewer::Server::update() {
  const Time time = now();
  maker.update(time);
  bool requests_field = false;
  for (Page& page : pages) {
    requests_field = requests_field || page.link.requests_field();
    if (page.link.too_quiet(time)) end(page, LWS_CLOSE_STATUS_POLICY_VIOLATION, "no hello");
    if (page.link.greeted()) lws_callback_on_writable(page.wsi);
  }
  feed.requests_field = requests_field;
  while (const auto silent = connections.take_silent(time)) close_later(*silent);
}

int Viewer::Server::on_request(lws* wsi, Fetch& fetch) {
  fetch = {};
  char* path = nullptr;
  int length = 0;
  const int method = lws_http_get_uri_and_method(wsi, &path, &length);
  const std::string host = header_of(wsi, WSI_TOKEN_HOST);
  const PageFile none{"", "text/plain; charset=utf-8", {}};
  if (method != LWSHUMETH_GET && method != LWSHUMETH_HEAD)
    return send_head(wsi, HTTP_STATUS_METHOD_NOT_ALLOWED, none, "", true, fetch), -1;
  if (!host_is_ours(host, address.typed)) return send_head(wsi, HTTP_STATUS_FORBIDDEN, none, "", true, fetch);
  const std::string_view requested(path, static_cast<std::size_t>(std::max(length, 0)));
  const bool head_only = method == LWSHUMETH_HEAD;
  if (requested == "/session" && session != nullptr) {
    const PageFile file{requested,
                        "application/octet-stream",
                        {reinterpret_cast<const char*>(session->data()), session->size()}};
    return send_head(wsi, HTTP_STATUS_OK, file, host, head_only, fetch);
  }
  const PageFile* const file = page_file(requested);
  if (file == nullptr) return send_head(wsi, HTTP_STATUS_NOT_FOUND, none, "", head_only, fetch);
  return send_head(wsi, HTTP_STATUS_OK, *file, host, head_only, fetch);
}

int Viewer::Server::send_head(lws* wsi, unsigned status, const PageFile& file, const std::string& host,
                              bool head_only, Fetch& fetch) {
  std::array<unsigned char, LWS_PRE + 2048> bytes;
  unsigned char *const begin = bytes.data() + LWS_PRE, *at = begin, *const end = bytes.data() + bytes.size();
  bool fits = lws_add_http_common_headers(wsi, status, std::string(file.type).c_str(), file.bytes.size(), &at,
                                          end) == 0;
  const auto add = [&](const char* name, const std::string& value) {
    fits = fits && lws_add_http_header_by_name(wsi, reinterpret_cast<const unsigned char*>(name),
                                               reinterpret_cast<const unsigned char*>(value.data()),
                                               static_cast<int>(value.size()), &at, end) == 0;
  };
  add("cache-control:", "no-store");
  add("x-content-type-options:", "nosniff");
  add("referrer-policy:", "no-referrer");
  add("cross-origin-resource-policy:", "same-origin");
  if (!host.empty()) add("content-security-policy:", security_policy(host));
  if (!fits || lws_finalize_write_http_header(wsi, begin, &at, end) != 0) return -1;
  if (head_only || file.bytes.empty()) return complete(wsi);
  fetch = {file.bytes.data(), file.bytes.size()};
  lws_callback_on_writable(wsi);
  return 0;
}

int Viewer::Server::send_chunk(lws* wsi, Fetch& fetch) {
  if (fetch.remaining == 0) return -1;
  const std::size_t size = std::min(kChunk, fetch.remaining);
  buffer.resize(LWS_PRE + size);
  std::memcpy(buffer.data() + LWS_PRE, fetch.next, size);
  fetch = {fetch.next + size, fetch.remaining - size};
  const auto kind = fetch.remaining == 0 ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP;
  if (lws_write(wsi, reinterpret_cast<unsigned char*>(buffer.data()) + LWS_PRE, size, kind) < 0) return -1;
  if (fetch.remaining == 0) return complete(wsi);
  lws_set_timeout(wsi, PENDING_TIMEOUT_HTTP_CONTENT, kPatience);
  lws_callback_on_writable(wsi);
  return 0;
}

/// Ends the answer to a request; the connection may bring another one.
int Viewer::Server::complete(lws* wsi) {
  connections.answered(wsi, now());
  return lws_http_transaction_completed(wsi) != 0 ? -1 : 0;
}

bool Viewer::Server::may_connect(lws* wsi) const {
  const std::string host = header_of(wsi, WSI_TOKEN_HOST);
  return pages.size() < kMostPages && header_of(wsi, WSI_TOKEN_GET_URI) == "/live" &&
         host_is_ours(host, address.typed) && same_origin(header_of(wsi, WSI_TOKEN_ORIGIN), host);
}

void Viewer::Server::open(lws* wsi, Page*& page) {
  // What waits in the system is old when it comes.
  const int fd = lws_get_socket_fd(wsi);
  setsockopt(fd, IPPROTO_TCP, TCP_NOTSENT_LOWAT, &kUnsent, sizeof kUnsent);
  page = &pages.emplace_back(Page{wsi, PageLink(now()), {}, {}});
  feed.pages = static_cast<int>(pages.size());
}

/// Ends a page when the connection takes that, or after a while without.
void Viewer::Server::end(Page& page, lws_close_status why, std::string text) {
  if (page.end) return;
  page.end = {why, std::move(text)};
  lws_set_timeout(page.wsi, PENDING_TIMEOUT_USER_REASON_BASE, kPatience);
  lws_callback_on_writable(page.wsi);
}

void Viewer::Server::on_message(Page& page, std::string_view part) {
  if (page.end) return;
  if (lws_frame_is_binary(page.wsi) != 0)
    return end(page, LWS_CLOSE_STATUS_UNACCEPTABLE_OPCODE, "text, please");
  if (page.coming.size() + part.size() > kLongestPageMessage)
    return end(page, LWS_CLOSE_STATUS_MESSAGE_TOO_LARGE, "too long");
  page.coming += part;
  if (lws_remaining_packet_payload(page.wsi) > 0 || lws_is_final_fragment(page.wsi) == 0) return;
  if (!page.link.may_say(now())) return end(page, LWS_CLOSE_STATUS_POLICY_VIOLATION, "too many messages");
  const auto message = read_page_message(std::exchange(page.coming, {}));
  const bool paused = feed.paused;
  if (!message || !requests.obey(page.link, *message))
    return end(page, LWS_CLOSE_STATUS_POLICY_VIOLATION, "no message that is known here");
  if (feed.paused != paused) update();
  lws_callback_on_writable(page.wsi);
}

int Viewer::Server::send_next(Page& page) {
  if (page.end) {
    std::string& text = page.end->text;
    lws_close_reason(page.wsi, page.end->why, reinterpret_cast<unsigned char*>(text.data()), text.size());
    return -1;
  }
  const auto kind = page.link.next(maker.showing(), now(), sent);
  if (!kind) return 0;
  buffer.resize(LWS_PRE + sent.size());
  std::memcpy(buffer.data() + LWS_PRE, sent.data(), sent.size());
  const auto how = *kind == PageLink::Kind::kText ? LWS_WRITE_TEXT : LWS_WRITE_BINARY;
  if (lws_write(page.wsi, reinterpret_cast<unsigned char*>(buffer.data()) + LWS_PRE, sent.size(), how) < 0)
    return -1;
  lws_callback_on_writable(page.wsi);  // there may be more
  return 0;
}

Viewer::Viewer(const ViewerAddress& address, std::string token, const SceneFacts& scene, ViewerFeed& feed,
               const Bytes* session)
    : server_(std::make_unique<Server>(address, std::move(token), scene, feed, session)) {}

Viewer::~Viewer() = default;

const protocol::Endpoint& Viewer::endpoint() const {
  return server_->address.endpoint;
}

void Viewer::run() noexcept {
  while (!server_->stops && lws_service(server_->context, 0) >= 0) {
  }
}

void Viewer::stop() noexcept {
  server_->stops = true;
  ring();
}

void Viewer::ring() noexcept {
  lws_cancel_service(server_->context);
}

}  // namespace palpate::sim
