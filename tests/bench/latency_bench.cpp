// From one program to another over loopback: our socket, with its event loop, against two that block on a
// plain one.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

#include "common/clock.h"
#include "common/doorbell.h"
#include "protocol/auth.h"
#include "protocol/udp_socket.h"
#include "tests/bench/bench.h"

namespace palpate::bench {
using namespace protocol;

namespace {

constexpr int kTrips = 2000;  // there and back, in one timing

/// s, of one way.
double one_way(Time begin) {
  return to_seconds(now() - begin) / (2 * kTrips);
}

/// A datagram as large as a sample with two tangents, with a tag.
struct Ball {
  std::array<std::byte, kMaxDatagram> bytes{};
  std::size_t size = 0;
  Ball() {
    ForceSample sample{.number = 1};
    sample.flags = ForceSample::kHasTangent | ForceSample::kHasAhead | ForceSample::kHasErrors;
    size = seal(bytes, encode({1, 1}, sample, bytes), Key{.number = 1});
  }
  std::span<const std::byte> used() const { return {bytes.data(), size}; }
};

/// A blocking socket on loopback that talks to `port`.
class PlainSocket {
 public:
  PlainSocket() : descriptor_(socket(AF_INET, SOCK_DGRAM, 0)) {
    address_.sin_family = AF_INET;
    address_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address_;
    if (bind(descriptor_, reinterpret_cast<sockaddr*>(&address_), size) != 0 ||
        getsockname(descriptor_, reinterpret_cast<sockaddr*>(&address_), &size) != 0)
      fail_at_run_time("no UDP socket on 127.0.0.1");
  }
  ~PlainSocket() { close(descriptor_); }
  PlainSocket(const PlainSocket&) = delete;
  PlainSocket& operator=(const PlainSocket&) = delete;

  void talk_to(const PlainSocket& other) {
    if (connect(descriptor_, reinterpret_cast<const sockaddr*>(&other.address_), sizeof other.address_) != 0)
      fail_at_run_time("cannot connect on 127.0.0.1");
  }
  void send(std::span<const std::byte> bytes) { (void)::send(descriptor_, bytes.data(), bytes.size(), 0); }
  std::size_t receive(std::span<std::byte> bytes) {
    return static_cast<std::size_t>(std::max<ssize_t>(recv(descriptor_, bytes.data(), bytes.size(), 0), 0));
  }

 private:
  int descriptor_;
  sockaddr_in address_{};
};

void run_plain(benchmark::State& state) {
  const Ball ball;
  PlainSocket at_tool, there;
  at_tool.talk_to(there);
  there.talk_to(at_tool);
  std::jthread echo([&] {
    std::array<std::byte, 2048> bytes;
    for (;;) {
      const std::size_t size = there.receive(bytes);
      if (size <= 1) return;
      there.send({bytes.data(), size});
    }
  });
  std::array<std::byte, 2048> bytes;
  for (auto _ : state) {
    const Time begin = now();
    for (int i = 0; i < kTrips; ++i) {
      at_tool.send(ball.used());
      benchmark::DoNotOptimize(at_tool.receive(bytes));
    }
    state.SetIterationTime(one_way(begin));
  }
  at_tool.send(ball.used().first(1));
}

void run_ours(benchmark::State& state) {
  const Ball ball;
  const Endpoint any = resolve("127.0.0.1:0", "bench");
  UdpSocket there(any);
  std::jthread echo([&] {
    Doorbell other;
    there.run(other, std::chrono::seconds(1),
              {.on_datagram = [&](auto bytes, const Endpoint& from) { there.send(bytes, from); },
               .on_doorbell = [] {},
               .on_timer = [] {}});
  });
  const Endpoint to = there.local();
  for (auto _ : state) {
    UdpSocket at_tool(any);
    Doorbell bell;
    int remaining = kTrips;
    const auto again = [&](auto, const Endpoint&) {
      if (--remaining == 0) return at_tool.stop();
      at_tool.send(ball.used(), to);
    };
    const Time begin = now();
    at_tool.send(ball.used(), to);
    at_tool.run(bell, std::chrono::seconds(1),
                {.on_datagram = again, .on_doorbell = [] {}, .on_timer = [] {}});
    state.SetIterationTime(one_way(begin));
  }
  there.stop();
}

}  // namespace

void add_latency_rows() {
  add("latency/plain", run_plain)->UseManualTime()->Iterations(20);
  add("latency/ours", run_ours)->UseManualTime()->Iterations(20);
}

}  // namespace palpate::bench
