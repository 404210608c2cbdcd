// A bad network between two programs of ours, in real time: clients talk to this one, it talks to the server,
// and what it does to the datagrams between is drawn from a seed (protocol/link_simulator.h). Behind
// scripts/two_machines.
#include <fmt/core.h>
#include <map>
#include <memory>
#include <thread>

#include "common/clock.h"
#include "common/error.h"
#include "common/interrupt.h"
#include "common/program.h"
#include "protocol/link_simulator.h"
#include "protocol/udp_socket.h"

namespace {

using namespace palpate;
using namespace palpate::protocol;

struct Options {
  std::string listen, server;
  std::uint64_t seed = 1;
  double delay_ms = 0, jitter_ms = 0, loss = 0, burst = 0, burst_length = 5, duplicates = 0, reordered = 0,
         reorder_ms = 20, mbit = 0;

  LinkConditions conditions() const {
    return {.delay = 1e-3 * delay_ms,
            .jitter = 1e-3 * jitter_ms,
            .loss = 1e-2 * loss,
            .burst_start = 1e-2 * burst,
            .burst_end = 1 / burst_length,
            .duplicates = 1e-2 * duplicates,
            .reordered = 1e-2 * reordered,
            .reorder_delay = 1e-3 * reorder_ms,
            .bandwidth = mbit * 1e6 / 8};
  }
};

/// What lies between one client and the server: a socket that stands for it there, and a link each way.
struct Path {
  Path(const Options& o, std::uint64_t seed) : up(o.conditions(), seed), down(o.conditions(), seed + 1) {}
  std::unique_ptr<UdpSocket> at_server;
  LinkSimulator up, down;
};

/// Each client, by its address, has a path of its own.
class Relay {
 public:
  explicit Relay(const Options& options)
      : options_(options),
        socket_(resolve(options.listen, "--listen")),
        server_(resolve(options.server, "--server")) {}

  void run() {
    Doorbell bell;
    socket_.run(bell, kPeriod,
                {.on_datagram = [this](auto bytes, const Endpoint& from) { from_client(bytes, from); },
                 .on_doorbell = [] {},
                 .on_timer = [this] { pass(); }});
  }
  void stop() { socket_.stop(); }
  void print() const {
    for (const auto& [client, path] : paths_) {
      print(fmt::format("{} to the server:", to_string(client)), path->up.counts());
      print(fmt::format("{} from the server:", to_string(client)), path->down.counts());
    }
  }

 private:
  static constexpr Time kPeriod = std::chrono::microseconds(200);
  static constexpr std::size_t kMostClients = 64;

  static void print(const std::string& direction, const LinkCounts& c) {
    fmt::print(
        "link_relay: {} {} sent, {} delivered, {} lost, {} lost in bursts, {} dropped by the queue, {} "
        "doubled, {} reordered\n",
        direction, c.sent, c.delivered, c.lost, c.lost_in_bursts, c.dropped_by_queue, c.duplicated,
        c.reordered);
  }
  void from_client(std::span<const std::byte> bytes, const Endpoint& from) {
    std::unique_ptr<Path>& path = paths_[from];
    if (!path) path = open_path(from);
    path->up.send(bytes, now());
    pass();
  }
  std::unique_ptr<Path> open_path(const Endpoint& client) {
    if (paths_.size() > kMostClients) fail_at_run_time("more than {} clients", kMostClients);
    auto path = std::make_unique<Path>(options_, options_.seed + 2 * paths_.size());
    path->at_server = std::make_unique<UdpSocket>(Endpoint{.v6 = client.v6}, socket_,
                                                  [this, p = path.get()](auto bytes, const Endpoint& from) {
                                                    if (from == server_) p->down.send(bytes, now());
                                                    pass();
                                                  });
    return path;
  }
  /// All that has arrived.
  void pass() {
    for (const auto& [client, path] : paths_) {
      if (!path) continue;
      while (const auto bytes = path->up.receive(now())) path->at_server->send(*bytes, server_);
      while (const auto bytes = path->down.receive(now())) socket_.send(*bytes, client);
    }
  }

  Options options_;
  UdpSocket socket_;
  Endpoint server_;
  std::map<Endpoint, std::unique_ptr<Path>> paths_;
};

int pass_on(const Options& options) {
  Relay relay(options);
  std::jthread net([&] { relay.run(); });
  fmt::print("link_relay: from {} to {}\n", options.listen, options.server);
  std::fflush(stdout);
  while (!wait_for_interrupt(std::chrono::milliseconds(200))) {
  }
  relay.stop();
  net.join();
  relay.print();
  return 0;
}

Command link_relay() {
  const auto o = std::make_shared<Options>();
  const OptionRules percent{.shows_default = true, .within = Bounds{0, 100}},
      ms{.shows_default = true, .within = Bounds{0, 10000}};
  return {.name = "link_relay",
          .summary = "Passes the datagrams of a client and a server on, over a network as bad as asked for.",
          .footer =
              "Example: link_relay --listen 127.0.0.3:45130 --server 127.0.0.2:45130 --delay 20 --jitter 5 "
              "--loss 2",
          .options =
              {{"--listen", "ADDR:PORT where the client believes the server", &o->listen, {.required = true}},
               {"--server", "ADDR:PORT of the server", &o->server, {.required = true}},
               {"--seed", "Of all that is drawn", &o->seed, {.shows_default = true}},
               {"--delay", "One way, ms", &o->delay_ms, ms},
               {"--jitter", "More, even from 0 to this, ms", &o->jitter_ms, ms},
               {"--loss", "Lost, each on its own, %", &o->loss, percent},
               {"--burst", "With which a burst of losses begins, %", &o->burst, percent},
               {"--burst-length",
                "Of a burst on average, datagrams",
                &o->burst_length,
                {.shows_default = true, .within = Bounds{1, 1000}}},
               {"--duplicates", "Arrive twice, %", &o->duplicates, percent},
               {"--reordered", "Held back, %", &o->reordered, percent},
               {"--reorder-delay", "By so much, ms", &o->reorder_ms, ms},
               {"--mbit",
                "Rate of the line, Mbit/s; 0: any",
                &o->mbit,
                {.shows_default = true, .within = Bounds{0, 100000}}}},
          .run = [o] { return pass_on(*o); }};
}

}  // namespace

int main(int argc, char** argv) {
  return palpate::run_program("link_relay", argc, argv, &link_relay);
}
