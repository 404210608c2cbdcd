#include "sim_server/viewer/access.h"

#include <unistd.h>

#include "common/error.h"
#include "protocol/auth.h"
#include "protocol/udp_socket.h"
#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::sim;

TEST_CASE("viewer: an address is a port on this machine, or all of it as typed") {
  CHECK(protocol::to_string(read_viewer_address("8080")->endpoint) == "127.0.0.1:8080");
  CHECK(protocol::to_string(read_viewer_address("0.0.0.0:80")->endpoint) == "0.0.0.0:80");
  CHECK(protocol::to_string(read_viewer_address("[::1]:8080")->endpoint) == "[::1]:8080");
  CHECK(read_viewer_address("localhost:0")->typed == "localhost");
  CHECK_FALSE(read_viewer_address("off"));
  for (const char* wrong : {"", "on", "70000", "8080x", "127.0.0.1", "no.such.host.invalid:80", "1:2:3"}) {
    CAPTURE(wrong);
    CHECK_THROWS_AS(read_viewer_address(wrong), Error);
  }
}

TEST_CASE("viewer: a name that somebody else may lead here is not ours") {
  for (const char* ours : {"localhost", "LOCALHOST:9000", "127.0.0.1", "127.0.0.1:8080", "192.168.1.4:8080",
                           "[::1]:8080", "[fe80::1]", "typed.example:80", "Typed.Example"}) {
    CAPTURE(ours);
    CHECK(host_is_ours(ours, "typed.example"));
  }
  for (const char* other :
       {"", "evil.example", "evil.example:8080", "localhost.evil.example", "127.0.0.1.evil.example",
        "localhost:", "localhost:80:80", "127.0.0.1:80x", "[::1", "[::1]x", "1.2.3", "typed.example.evil"}) {
    CAPTURE(other);
    CHECK_FALSE(host_is_ours(other, "typed.example"));
  }
  CHECK_FALSE(host_is_ours("typed.example", ""));
  std::array<char, 256> name{};
  REQUIRE(gethostname(name.data(), name.size() - 1) == 0);
  CHECK(host_is_ours(std::string(name.data()) + ":8080", ""));
}

TEST_CASE("viewer: only a page from here may open the WebSocket") {
  CHECK(same_origin("http://127.0.0.1:8080", "127.0.0.1:8080"));
  CHECK(same_origin("https://LocalHost", "localhost"));
  for (const char* origin : {"", "null", "http://evil.example", "http://127.0.0.1:8081", "127.0.0.1:8080",
                             "http://127.0.0.1:8080/", "ftp://127.0.0.1:8080"}) {
    CAPTURE(origin);
    CHECK_FALSE(same_origin(origin, "127.0.0.1:8080"));
  }
  CHECK_FALSE(same_origin("http://", ""));
}

TEST_CASE("viewer: the token of a key is always the same, and of another key another") {
  using protocol::page_token;
  const protocol::Key key{.number = 1, .bytes = {1, 2, 3}}, other{.number = 1, .bytes = {1, 2, 4}};
  CHECK(page_token(key) == page_token(key));
  CHECK(page_token(key) != page_token(other));
  CHECK(hex_token(page_token(key)).size() == 32);
  CHECK(hex_token({0x01, 0xab}).substr(0, 4) == "01ab");
  // Python: hashlib.blake2b(b"page" + bytes(20), digest_size=16, key=bytes([1, 2, 3]) +
  // bytes(29)).hexdigest()
  CHECK(hex_token(page_token(key)) == "f0c94717f812d7de86bad5331b31e540");
}

TEST_CASE("viewer: the token of a run needs its key and its random number") {
  const protocol::Key key{.number = 1, .bytes = {1, 2, 3}}, other{.number = 1, .bytes = {1, 2, 4}};
  const std::string token = token_of(key, {5, 6});
  CHECK(token.size() == 32);
  CHECK(token != token_of(key, {5, 7}));
  CHECK(token != token_of(key, {4, 6}));
  CHECK(token != token_of(other, {5, 6}));
  CHECK(token != hex_token(protocol::page_token(key)));
}

TEST_CASE("viewer: a token is equal to itself alone") {
  using protocol::equal_in_constant_time;
  CHECK(equal_in_constant_time("0123", "0123"));
  for (const char* other : {"", "012", "01234", "0124", "1123"})
    CHECK_FALSE(equal_in_constant_time("0123", other));
}
