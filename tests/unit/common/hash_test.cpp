#include "common/hash.h"

#include <string_view>

#include "tests/support/catch.h"

using namespace palpate;

namespace {
std::uint64_t hash_of(std::string_view text) {
  Fnv1a hash;
  hash.add(text.data(), text.size());
  return hash.value();
}
}  // namespace

TEST_CASE("hash: the published values of FNV-1a, 64 bits") {
  CHECK(hash_of("") == 0xcbf29ce484222325u);
  CHECK(hash_of("a") == 0xaf63dc4c8601ec8cu);
  CHECK(hash_of("foobar") == 0x85944171f73967e8u);
}

TEST_CASE("hash: in pieces as in one") {
  Fnv1a hash;
  hash.add("foo", 3);
  hash.add("bar", 3);
  CHECK(hash.value() == hash_of("foobar"));
}
