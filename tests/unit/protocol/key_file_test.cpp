#include "protocol/key_file.h"

#include <fstream>
#include <sys/stat.h>

#include "common/error.h"
#include "protocol/udp_socket.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using namespace palpate::protocol;

namespace {

struct KeyFolder {
  test::TemporaryFolder folder;
  std::filesystem::path file = folder.path() / "palpate.key";

  void write(const std::string& text) {
    std::ofstream(file) << text;
    ::chmod(file.c_str(), 0600);
  }
  std::string error_of(const std::string& text) {
    write(text);
    try {
      read_keys(file);
    } catch (const Error& error) {
      return error.what();
    }
    return "none";
  }
};

const std::string kHex = "000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f";

bool needs_key(const char* address) {
  try {
    require_key(resolve(address, "test"), false, false, "--listen");
    return false;
  } catch (const Error&) {
    return true;
  }
}

}  // namespace

TEST_CASE("a key file is read, with comments, the newest last") {
  KeyFolder f;
  f.write("# a comment\n\n palpate-key 7 " + kHex + "  # old\r\npalpate-key 2 " + std::string(64, 'F') +
          "\n");
  const auto keys = read_keys(f.file);
  REQUIRE(keys.size() == 2);
  CHECK(keys[0].number == 7);
  CHECK(keys[0].bytes[31] == 31);
  CHECK(keys[1].number == 2);
  CHECK(keys[1].bytes[0] == 0xff);
}

TEST_CASE("a key file that is wrong is refused with file and line, and one that others may read at all") {
  KeyFolder f;
  using Catch::Contains;
  CHECK_THAT(f.error_of(""), Contains("holds no key"));
  CHECK_THAT(f.error_of("# only a comment\npalpate 1 " + kHex), Contains("palpate.key:2: expected"));
  CHECK_THAT(f.error_of("palpate-key 0 " + kHex), Contains("1 to 255"));
  CHECK_THAT(f.error_of("palpate-key 256 " + kHex), Contains("1 to 255"));
  CHECK_THAT(f.error_of("palpate-key 1 " + kHex + " x"), Contains("expected"));
  CHECK_THAT(f.error_of("palpate-key 1 " + kHex.substr(2)), Contains("has 62 characters"));
  CHECK_THAT(f.error_of("palpate-key 1 " + kHex.substr(2) + "zz"), Contains("64 hexadecimal digits"));
  CHECK_THAT(f.error_of("palpate-key 1 " + kHex + "\npalpate-key 1 " + kHex),
             Contains(":2: key 1 is there twice"));
  f.write("palpate-key 1 " + kHex);
  for (const mode_t mode : {0640, 0604, 0620}) {
    ::chmod(f.file.c_str(), mode);
    CHECK_THROWS_WITH(read_keys(f.file),
                      Contains("others than its owner may read it") && Contains("chmod 600"));
  }
  std::filesystem::remove(f.file);
  CHECK_THROWS_WITH(read_keys(f.file), Contains("cannot be read") && Contains("keygen"));
}

TEST_CASE("a new key is random, in a file of its owner's alone, and replaces none") {
  KeyFolder f;
  const Key first = add_new_key(f.file, false);
  struct stat status {};
  REQUIRE(::stat(f.file.c_str(), &status) == 0);
  CHECK((status.st_mode & 0777) == 0600);
  CHECK(first.number == 1);
  CHECK(read_keys(f.file)[0].bytes == first.bytes);
  CHECK_THROWS_WITH(add_new_key(f.file, false), Catch::Contains("is there already"));
  const Key second = add_new_key(f.file, true);
  CHECK(second.number == 2);
  CHECK(second.bytes != first.bytes);
  const auto keys = read_keys(f.file);
  REQUIRE(keys.size() == 2);
  CHECK(keys[0].bytes == first.bytes);
  CHECK(keys[1].bytes == second.bytes);
  CHECK((::stat(f.file.c_str(), &status) == 0 && (status.st_mode & 0777) == 0600));
  const std::filesystem::directory_iterator files(f.folder.path());
  CHECK(std::distance(begin(files), end(files)) == 1);  // nothing stays beside it
  CHECK_THROWS_AS(add_new_key(f.folder.path() / "none.key", true), Error);
  CHECK_THROWS_AS(add_new_key(f.folder.path() / "none" / "a.key", false), Error);
}

TEST_CASE("a new key goes behind others in any order, and behind a last line that does not end") {
  KeyFolder f;
  add_new_key(f.file, false);
  std::string text;
  {
    std::ifstream in(f.file);
    text.assign(std::istreambuf_iterator<char>(in), {});
  }
  const std::string line = text.substr(text.rfind('\n', text.size() - 2) + 1);
  std::string seventh = line;
  seventh.replace(seventh.find(" 1 "), 3, " 7 ");
  { std::ofstream(f.file) << seventh << line.substr(0, line.size() - 1); }
  CHECK(add_new_key(f.file, true).number == 8);
  CHECK(read_keys(f.file).size() == 3);
}

TEST_CASE("only on this machine is no key needed") {
  for (const char* address : {"127.0.0.1:1", "127.8.9.10:1", "[::1]:1", "[::ffff:127.0.0.1]:1"})
    CHECK_FALSE(needs_key(address));
  for (const char* address :
       {"0.0.0.0:1", "10.0.0.1:1", "[::]:1", "[fe80::1]:1", "[::ffff:10.0.0.1]:1", "[::2]:1"})
    CHECK(needs_key(address));
  CHECK_NOTHROW(require_key(resolve("10.0.0.1:1", "test"), true, false, "--listen"));
  CHECK_NOTHROW(require_key(resolve("10.0.0.1:1", "test"), false, true, "--listen"));
}
