// The socket on the loopback interface, which answers at every address of 127.0.0.0/8.
#include "protocol/udp_socket.h"

#include <thread>

#include "common/clock.h"
#include "common/doorbell.h"
#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::protocol;

namespace {

/// A socket in a thread of its own that says back what it hears, as NetLink does.
struct Echo {
  explicit Echo(const std::string& address) : socket(resolve(address, "test")) {
    thread = std::jthread([this] {
      socket.run(
          bell, std::chrono::seconds(1),
          {.on_datagram = [this](auto bytes,
                                 const Endpoint& from) { socket.send(bytes, from, socket.requested()); },
           .on_doorbell = [] {},
           .on_timer = [] {}});
    });
  }
  ~Echo() {
    socket.stop();
    thread.join();
  }
  UdpSocket socket;
  Doorbell bell;
  std::jthread thread;
};

struct Answer {
  Endpoint from;
  Time sent, arrived, handled;
};

/// What comes back from `to` within a second.
std::optional<Answer> ask(const Endpoint& to, Time nap = {}) {
  UdpSocket socket(Endpoint{.v6 = to.v6});
  Doorbell bell;
  std::optional<Answer> answer;
  const std::array<std::byte, 4> bytes{};
  const Time sent = now();
  CHECK(!socket.send(bytes, to));
  sleep_until(sent + nap);
  int seconds = 0;
  socket.run(bell, std::chrono::seconds(1),
             {.on_datagram =
                  [&](auto, const Endpoint& from) {
                    answer = {from, sent, socket.arrived(), now()};
                    socket.stop();
                  },
              .on_doorbell = [] {},
              .on_timer = [&] { seconds++ > 0 ? socket.stop() : void(); }});
  return answer;
}

}  // namespace

TEST_CASE("a socket bound to every address answers from the one that was asked") {
  Echo echo("0.0.0.0:0");
  for (const char* address : {"127.0.0.1", "127.0.0.7", "127.1.2.3"}) {
    Endpoint to = resolve(std::string(address) + ":1", "test");
    to.port = echo.socket.local().port;
    const auto answer = ask(to);
    REQUIRE(answer);
    CHECK(to_string(answer->from) == to_string(to));
  }
}

TEST_CASE("a socket bound to one address, and one of IPv6, answer as well") {
  for (const char* address : {"127.0.0.3:0", "[::1]:0", "[::]:0"}) {
    Echo echo(address);
    Endpoint to = resolve(std::string(address).starts_with('[') ? "[::1]:1" : "127.0.0.3:1", "test");
    to.port = echo.socket.local().port;
    const auto answer = ask(to);
    REQUIRE(answer);
    CHECK(answer->from == to);
  }
}

TEST_CASE("an address that is ours no more does not keep a datagram from leaving") {
  Echo echo("127.0.0.1:0");
  UdpSocket socket(Endpoint{});
  const std::array<std::byte, 4> bytes{};
  const Endpoint removed{.address = {192, 0, 2, 1}, .port = 1};
  CHECK(!socket.send(bytes, echo.socket.local(), removed));
}

TEST_CASE("a datagram arrived when the kernel had it, however late it is read", "[in_time]") {
  Echo echo("127.0.0.1:0");
  const auto answer = ask(echo.socket.local(), std::chrono::milliseconds(60));
  REQUIRE(answer);
  CHECK(answer->handled - answer->sent >= std::chrono::milliseconds(60));
  CHECK(answer->arrived > answer->sent);
  CHECK(answer->arrived < answer->handled - std::chrono::milliseconds(10));
}

TEST_CASE("a link-local address keeps its interface") {
  const Endpoint endpoint = resolve("[fe80::1%lo]:45130", "test");
  CHECK(endpoint.v6);
  CHECK(endpoint.scope > 0);
  CHECK(to_string(endpoint) == "[fe80::1%lo]:45130");
}

TEST_CASE("a link-local address without an interface is refused with one that has it") {
  CHECK_THROWS_WITH(resolve("[fe80::1]:45130", "--server"),
                    Catch::Matchers::Contains("[fe80::1%eth0]:45130"));
}

TEST_CASE("the network says that nothing listens at a port, and nothing where something does") {
  Endpoint gone;
  {
    const UdpSocket socket(resolve("127.0.0.1:0", "test"));
    gone = socket.local();
    CHECK(!UdpSocket::answer_of(gone, {}, std::chrono::milliseconds(50)).error);
  }
  CHECK(UdpSocket::answer_of(gone, {}, std::chrono::seconds(5)).error == std::errc::connection_refused);
}
