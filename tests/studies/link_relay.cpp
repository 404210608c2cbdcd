// A bad network between two programs of ours, in real time: clients talk to this one, it talks to the server,
// and what it does to the datagrams between is drawn from a seed (protocol/link_simulator.h). Behind
// scripts/two_machines.
#include <CLI/CLI.hpp>
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
            .burst_begin = 1e-2 * burst,
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

int run(int argc, char** argv) {
  CLI::App app{"Passes the datagrams of a client and a server on, over a network as bad as asked for."};
  Options o;
  app.add_option("--listen", o.listen, "ADDR:PORT where the client believes the server")->required();
  app.add_option("--server", o.server, "ADDR:PORT of the server")->required();
  app.add_option("--seed", o.seed, "Of all that is drawn")->capture_default_str();
  const CLI::Range percent(0, 100), ms(0, 10000);
  app.add_option("--delay", o.delay_ms, "One way, ms")->check(ms)->capture_default_str();
  app.add_option("--jitter", o.jitter_ms, "More, even from 0 to this, ms")->check(ms)->capture_default_str();
  app.add_option("--loss", o.loss, "Lost, each on its own, %")->check(percent)->capture_default_str();
  app.add_option("--burst", o.burst, "With which a burst of losses begins, %")
      ->check(percent)
      ->capture_default_str();
  app.add_option("--burst-length", o.burst_length, "Of a burst on average, datagrams")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--duplicates", o.duplicates, "Arrive twice, %")->check(percent)->capture_default_str();
  app.add_option("--reordered", o.reordered, "Held back, %")->check(percent)->capture_default_str();
  app.add_option("--reorder-delay", o.reorder_ms, "By so much, ms")->check(ms)->capture_default_str();
  app.add_option("--mbit", o.mbit, "Rate of the line, Mbit/s; 0: any")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str();
  app.footer(
      "Example: link_relay --listen 127.0.0.3:45130 --server 127.0.0.2:45130 --delay 20 --jitter 5 --loss 2");
  if (const auto ended = parse_arguments(app, argc, argv)) return *ended;
  Relay relay(o);
  std::jthread net([&] { relay.run(); });
  fmt::print("link_relay: from {} to {}\n", o.listen, o.server);
  std::fflush(stdout);
  while (!wait_for_interrupt(std::chrono::milliseconds(200))) {
  }
  relay.stop();
  net.join();
  relay.print();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return palpate::run_program("link_relay", argc, argv, &run);
}
