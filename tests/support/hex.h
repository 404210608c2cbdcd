#pragma once
#include <cstddef>
#include <fmt/core.h>
#include <span>
#include <string>
#include <vector>

namespace palpate::test {

using Bytes = std::vector<std::byte>;

/// From hexadecimal digits; blanks are for the reader.
inline Bytes bytes(const std::string& hex) {
  Bytes result;
  std::string digits;
  for (const char c : hex) {
    if (c != ' ') digits += c;
  }
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2) {
    result.push_back(static_cast<std::byte>(std::stoi(digits.substr(i, 2), nullptr, 16)));
  }
  return result;
}

/// Two small digits a byte.
inline std::string hex(std::span<const std::byte> data) {
  std::string text;
  for (const std::byte b : data) text += fmt::format("{:02x}", std::to_integer<int>(b));
  return text;
}

}  // namespace palpate::test
