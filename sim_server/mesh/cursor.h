#pragma once
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

#include "common/error.h"

namespace palpate::sim {

/// Returns what the user can do with a file that Gmsh reads and this program does not.
inline std::string gmsh_command(const std::string& file) {
  return fmt::format("convert it: `gmsh \"{}\" -save -format msh41 -o OUT.msh`", file);
}

inline bool is_space(char c) {
  return c == ' ' || c == '\n' || c == '\t' || c == '\r';
}

/// Walks the bytes of a file. The same calls read numbers written as text or as bytes, so that each section
/// is described once; whatever is not as it should be is an `Error` that says where.
class Cursor {
 public:
  Cursor(std::string file, std::string_view bytes) : file_(std::move(file)), bytes_(bytes) {}

  /// Reads numbers as bytes from this call on, in this machine's order; `number` reads 8 of them if `wide`.
  void set_binary(bool wide) {
    binary_ = true;
    wide_ = wide;
  }
  bool binary() const { return binary_; }
  std::size_t bytes_in_all() const { return bytes_.size(); }
  const std::string& file() const { return file_; }

  // `what` says in an error what was expected.
  std::int64_t integer(const char* what) {
    return binary_ ? bytes<std::int32_t>(what) : text<std::int32_t>(what);
  }
  /// The number of a node or an element, or a count.
  std::int64_t number(const char* what) {
    if (!binary_) return text<std::int64_t>(what);
    return wide_ ? bytes<std::int64_t>(what) : bytes<std::int32_t>(what);
  }
  double real(const char* what) { return binary_ ? bytes<double>(what) : text<double>(what); }

  /// A count that format 2.2 writes as a line of text even in a binary file.
  std::int64_t text_count(const char* what) {
    const auto count = text<std::int64_t>(what);
    if (binary_) end_line();
    return count;
  }

  template <class Number>
  Number text(const char* what) {
    start_token();
    Number value{};
    if (at_ + 1 < bytes_.size() && bytes_[at_] == '+' && bytes_[at_ + 1] != '-')
      ++at_;  // from_chars takes none
    const char* const last = bytes_.data() + bytes_.size();
    const auto [end, error] = std::from_chars(bytes_.data() + at_, last, value);
    const bool entire = end == last || is_space(*end);
    if (error != std::errc() || !entire) wrong("expected {}, found {}", what, found());
    at_ = static_cast<std::size_t>(end - bytes_.data());
    return value;
  }

  template <class Number>
  Number bytes(const char* what) {
    token_ = at_;
    if (remaining() < sizeof(Number)) {
      wrong("expected {} ({} bytes), but {} bytes are left in the file", what, sizeof(Number), remaining());
    }
    Number value;
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }

  /// `count` as a size that is safe to allocate: the rest of the file could hold that many items of `numbers`
  /// numbers each.
  std::size_t size(std::int64_t count, std::int64_t numbers, const char* what) const {
    const std::int64_t shortest = binary_ ? 4 : 2;  // bytes of a number; as text, a digit and a space
    // Indices into the mesh are int.
    const auto most = std::min<std::int64_t>(static_cast<std::int64_t>(remaining()) / shortest / numbers,
                                             std::numeric_limits<int>::max());
    if (count < 0 || count > most) {
      wrong("{} {} announced, but the rest of the file has room for at most {}", count, what, most);
    }
    return static_cast<std::size_t>(count);
  }

  /// Nothing but white space is left.
  bool at_end() {
    start_token();
    return remaining() == 0;
  }

  /// The rest of the line, without its end.
  std::string_view line() {
    token_ = at_;
    std::string_view rest = bytes_.substr(at_);
    rest = rest.substr(0, rest.find('\n'));
    at_ = std::min(at_ + rest.size() + 1, bytes_.size());
    while (!rest.empty() && is_space(rest.back())) rest.remove_suffix(1);
    return rest;
  }

  /// Nothing but the end of the line must follow.
  void end_line() {
    if (line().empty()) return;
    token_ = bytes_.find_first_not_of(" \t\r", token_);
    wrong("expected the end of the line, found {}", found());
  }

  /// The name on a `$Name` line.
  std::string section() {
    start_token();
    const std::string_view name = line();
    if (name.size() < 2 || name.size() > kLongestName || name[0] != '$')
      wrong("expected a section ($Name), found {}", found());
    return std::string(name.substr(1));
  }

  /// The next line must be `$EndName`.
  void end_section(const std::string& name) {
    start_token();
    if (line() != "$End" + name) wrong("expected $End{}, found {}", name, found());
  }

  /// Goes past the line `$EndName`.
  void skip_section(const std::string& name) {
    const std::size_t start = token_;
    const std::string end = "$End" + name;
    do {
      at_ = std::min(bytes_.find(end, at_), bytes_.size());
      if (remaining() == 0) {
        token_ = start;
        wrong("section ${} has no {}: the file is cut short", name, end);
      }
    } while (line() != end);
  }

  /// Throws an `Error` about what was read or tried last.
  template <class... Args>
  [[noreturn]] void wrong(fmt::format_string<Args...> format, Args&&... args) const {
    fail("{}: {}", place(), fmt::format(format, std::forward<Args>(args)...));
  }

 private:
  static constexpr std::size_t kLongestName = 64;  // of a section

  std::size_t remaining() const { return bytes_.size() - at_; }
  void start_token() {
    while (at_ < bytes_.size() && is_space(bytes_[at_])) ++at_;
    token_ = at_;
  }

  std::string place() const {
    if (binary_) return fmt::format("{}: byte {}", file_, token_);
    return fmt::format("{}:{}", file_, 1 + std::count(bytes_.begin(), bytes_.begin() + token_, '\n'));
  }

  std::string found() const {
    constexpr std::size_t kShown = 24;  // characters of a word: the message stays one line
    std::string word;
    for (std::size_t i = token_; i < bytes_.size() && !is_space(bytes_[i]) && word.size() < kShown; ++i) {
      word += bytes_[i] >= ' ' && bytes_[i] <= '~' ? bytes_[i] : '?';
    }
    return token_ == bytes_.size() ? "the end of the file" : "\"" + word + "\"";
  }

  std::string file_;
  std::string_view bytes_;
  std::size_t at_ = 0, token_ = 0;  // the next byte; where the last item starts, for messages
  bool binary_ = false, wide_ = false;
};

}  // namespace palpate::sim
