#include "sim_server/viewer/connections.h"

#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

/// Opens `count` connections from an address, a millisecond apart from `from` on; `ids` name them.
void open_connections(Connections& connections, std::span<const int> ids, const char* address, Time from) {
  for (const int& id : ids) {
    REQUIRE_FALSE(connections.open(&id, address, from));
    from += std::chrono::milliseconds(1);
  }
}

}  // namespace

TEST_CASE("viewer: the oldest silent connection of an address goes for a new one of it") {
  Connections connections;
  const std::array<int, Connections::kMostOfAddress> ids{};
  const int new_one = 0, stranger = 0;
  REQUIRE_FALSE(connections.open(&stranger, "10.0.0.9", Time{}));  // older than all, but of another address
  open_connections(connections, ids, "10.0.0.1", std::chrono::seconds(1));
  CHECK(connections.open(&new_one, "10.0.0.1", std::chrono::seconds(2)) == &ids[0]);
}

TEST_CASE("viewer: a connection that is served stays, and one whose request is answered is the youngest") {
  Connections connections;
  const std::array<int, Connections::kMostOfAddress> ids{};
  const std::array<int, 3> later{};
  open_connections(connections, ids, "10.0.0.1", Time{});
  connections.serve(&ids[0]);
  connections.serve(&ids[1]);
  connections.answered(&ids[1], std::chrono::seconds(1));
  CHECK(connections.open(&later[0], "10.0.0.1", std::chrono::seconds(2)) == &ids[2]);
  for (const int& id : ids) connections.serve(&id);
  CHECK(connections.open(&later[1], "10.0.0.1", std::chrono::seconds(3)) == &later[0]);
  connections.serve(&later[1]);
  // All are served: there is room for none but of other addresses.
  CHECK(connections.open(&later[2], "10.0.0.1", std::chrono::seconds(4)) == &later[2]);
  CHECK_FALSE(connections.open(&later[2], "10.0.0.2", std::chrono::seconds(4)));
  connections.closed(&ids[5]);
  const int after = 0;
  CHECK_FALSE(connections.open(&after, "10.0.0.1", std::chrono::seconds(5)));
}

TEST_CASE("viewer: of a full port the oldest silent connection goes, whosever it is") {
  Connections connections;
  const std::array<int, Connections::kMostOfAddress> first{}, second{};
  static_assert(Connections::kMost == 2 * Connections::kMostOfAddress);
  open_connections(connections, first, "10.0.0.1", std::chrono::seconds(1));
  open_connections(connections, second, "10.0.0.2", Time{});
  const int new_one = 0;
  CHECK(connections.open(&new_one, "10.0.0.3", std::chrono::seconds(2)) == &second[0]);
}

TEST_CASE("viewer: a connection that says nothing for more than 5 s is closed, and none that is served") {
  Connections connections;
  const std::array<int, 3> ids{};
  open_connections(connections, ids, "10.0.0.1", Time{});
  connections.serve(&ids[0]);
  CHECK_FALSE(connections.take_silent(std::chrono::milliseconds(5001)));
  CHECK(connections.take_silent(std::chrono::milliseconds(5002)) == &ids[1]);
  CHECK_FALSE(connections.take_silent(std::chrono::milliseconds(5002)));
  CHECK(connections.take_silent(std::chrono::seconds(60)) == &ids[2]);
  CHECK_FALSE(connections.take_silent(std::chrono::seconds(60)));
  connections.answered(&ids[0], std::chrono::seconds(60));
  CHECK_FALSE(connections.take_silent(std::chrono::seconds(65)));
  CHECK(connections.take_silent(std::chrono::milliseconds(65'001)) == &ids[0]);
}
