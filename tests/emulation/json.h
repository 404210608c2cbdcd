#pragma once
#include <array>
#include <sstream>
#include <string>

#include "tests/emulation/vec.h"

namespace palpate::emulation {

/// One line of JSON, an object, key by key.
class JsonLine {
 public:
  JsonLine() { text_.precision(12); }
  void add(const char* key, double value) { begin(key) << value; }
  void add(const char* key, bool value) { begin(key) << (value ? "true" : "false"); }
  void add(const char* key, const std::string& value) { begin(key) << '"' << value << '"'; }
  void add(const char* key, const Vec& v) { begin(key) << '[' << v.x << ',' << v.y << ',' << v.z << ']'; }
  template <std::size_t n>
  void add(const char* key, const std::array<int, n>& values) {
    begin(key) << '[';
    for (std::size_t i = 0; i < n; ++i) text_ << (i ? "," : "") << values[i];
    text_ << ']';
  }
  std::string text() const { return text_.str() + "}"; }

 private:
  std::ostream& begin(const char* key) {
    text_ << (first_ ? "{" : ",") << '"' << key << "\":";
    first_ = false;
    return text_;
  }
  std::ostringstream text_;
  bool first_ = true;
};

}  // namespace palpate::emulation
