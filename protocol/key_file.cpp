#include "protocol/key_file.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <sstream>
#include <sys/stat.h>
#include <unistd.h>

#include "common/error.h"
#include "common/log.h"
#include "protocol/udp_socket.h"

namespace palpate::protocol {
namespace {

constexpr const char* kWord = "palpate-key";
constexpr std::size_t kMostKeys = 255;  // the number of a key is a byte of the header; 0 is none

/// Refuses a file that others can read: what two programs share must stay between them.
void require_private(const std::filesystem::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0)
    fail("{}: cannot be read ({}); `sim_server keygen {}` makes a key", file.string(), std::strerror(errno),
         file.string());
  if (!S_ISREG(status.st_mode)) fail("{}: is no file, but a folder, a pipe or a device", file.string());
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
    fail(
        "{}: others than its owner may read it (mode {:04o}); `chmod 600 {}`, and make a new key if they "
        "have",
        file.string(), status.st_mode & 0777U, file.string());
  }
}

std::optional<std::array<std::uint8_t, 32>> from_hex(const std::string& text) {
  std::array<std::uint8_t, 32> bytes;
  if (text.size() != 2 * bytes.size()) return {};
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const char* const digits = text.data() + 2 * i;
    const auto [end, error] = std::from_chars(digits, digits + 2, bytes[i], 16);
    if (error != std::errc{} || end != digits + 2) return {};
  }
  return bytes;
}

Key read_line(const std::string& line, const std::string& where) {
  std::istringstream words(line);
  std::string word, hex, more;
  int number = 0;
  words >> word >> number >> hex;
  if (word != kWord || number < 1 || number > 255 || words >> more)
    fail("{}: expected \"{} NUMBER HEX\", with a number from 1 to 255", where, kWord);
  const auto bytes = from_hex(hex);
  if (!bytes) fail("{}: a key has 64 hexadecimal digits, this one has {} characters", where, hex.size());
  if (std::ranges::count(*bytes, 0) == static_cast<std::ptrdiff_t>(bytes->size()))
    fail("{}: this key is all zeros, which anybody guesses; `sim_server keygen FILE` draws one", where);
  return {static_cast<std::uint8_t>(number), *bytes};
}

/// Writes it in one piece, and to the disk; else removes the file.
void write_atomically(int descriptor, const std::string& text, const std::filesystem::path& file) {
  const bool written = ::write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
                       ::fsync(descriptor) == 0;
  const int why = errno;
  ::close(descriptor);
  if (written) return;
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  fail_at_run_time("{}: cannot be written ({})", file.string(), std::strerror(why));
}

}  // namespace

std::vector<Key> read_keys(const std::filesystem::path& file) {
  require_private(file);
  std::ifstream in(file);
  std::vector<Key> keys;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    line = line.substr(0, line.find('#'));
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const std::string where = fmt::format("{}:{}", file.string(), number);
    const Key key = read_line(line, where);
    for (const Key& other : keys) {
      if (other.number == key.number) fail("{}: key {} is there twice", where, key.number);
    }
    keys.push_back(key);
  }
  if (keys.empty()) fail("{}: holds no key; `sim_server keygen FILE` makes one", file.string());
  return keys;
}

Key add_new_key(const std::filesystem::path& file, bool add) {
  Key key{1, random_value<std::array<std::uint8_t, 32>>()};
  std::string text;
  if (add) {
    const std::vector<Key> keys = read_keys(file);
    const std::uint8_t last = std::ranges::max(keys, {}, &Key::number).number;
    if (last == kMostKeys) fail("{}: has key 255, the last there is; make a new file", file.string());
    key.number = static_cast<std::uint8_t>(last + 1);
    std::ifstream in(file, std::ios::binary);
    text.assign(std::istreambuf_iterator<char>(in), {});
    if (!text.ends_with('\n')) text += '\n';
  } else {
    text =
        "# Whoever has this file can push the motors of a device. Copy it to both machines, keep it at mode "
        "0600.\n";
  }
  text += fmt::format("{} {} ", kWord, key.number);
  for (const std::uint8_t byte : key.bytes) text += fmt::format("{:02x}", byte);
  // A new one must not be there; one that is there is replaced as a whole.
  std::string written = add ? file.string() + ".XXXXXX" : file.string();
  const int descriptor =
      add ? ::mkostemp(written.data(), O_CLOEXEC)
          : ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (descriptor < 0 && errno == EEXIST)
    fail("{}: is there already; --add puts a new key behind the old ones, or choose another name",
         file.string());
  if (descriptor < 0) fail_at_run_time("{}: cannot be written ({})", written, std::strerror(errno));
  write_atomically(descriptor, text + "\n", written);
  if (add && std::rename(written.c_str(), file.c_str()) != 0) {
    const int why = errno;
    ::unlink(written.c_str());
    fail_at_run_time("{}: cannot be replaced ({})", file.string(), std::strerror(why));
  }
  return key;
}

bool is_loopback(const Endpoint& endpoint) noexcept {
  const auto& a = endpoint.address;
  if (!endpoint.v6) return a[0] == 127;
  const bool mapped =
      std::all_of(a.begin(), a.begin() + 10, [](auto b) { return b == 0; }) && a[10] == 255 && a[11] == 255;
  if (mapped) return a[12] == 127;
  return std::all_of(a.begin(), a.end() - 1, [](auto b) { return b == 0; }) && a[15] == 1;
}

void require_key(const Endpoint& endpoint, bool has_key, bool insecure, const std::string& where) {
  if (has_key || is_loopback(endpoint)) return;
  if (insecure) {
    log::warning(
        "{}: {} is not this machine, and there is no key: whoever can send datagrams there can push the "
        "motors",
        where, to_string(endpoint));
    return;
  }
  fail(
      "{}: {} is not this machine, so both programs need a key, or whoever can send datagrams there could "
      "push "
      "the motors; `sim_server keygen FILE` makes one, --key FILE uses it (--insecure goes without, on a "
      "network "
      "that you trust)",
      where, to_string(endpoint));
}

}  // namespace palpate::protocol
