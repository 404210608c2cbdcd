#include "sim_server/viewer/page_message.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/units.h"

namespace palpate::sim {
namespace {

using Parsed = nlohmann::json;

constexpr std::size_t kLongestName = 256;  // of a token, a scene, a field
constexpr int kDeepest = 4;                // of a message that is one of ours

/// Objects and arrays in one another; JSON's own reader knows no limit.
bool is_shallow(std::string_view text) {
  int depth = 0;
  for (const char c : text) {
    if (c == '{' || c == '[') ++depth;
    if (c == '}' || c == ']') --depth;
    if (depth > kDeepest) return false;
  }
  return true;
}

std::optional<std::string> name_in(const Parsed& value) {
  if (!value.is_string() || value.get_ref<const std::string&>().size() > kLongestName) return {};
  return value.get<std::string>();
}

std::optional<std::uint64_t> number_in(const Parsed& object, const char* key, std::uint64_t most) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number_unsigned() || found->get<std::uint64_t>() > most) return {};
  return found->get<std::uint64_t>();
}

std::optional<Vec3> place_in(const Parsed& object) {
  const auto found = object.find("p");
  if (found == object.end() || !found->is_array() || found->size() != 3) return {};
  Vec3 p;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(*found)[i].is_number()) return {};
    p[static_cast<Eigen::Index>(i)] = (*found)[i].get<double>();
  }
  if (!p.allFinite() || p.cwiseAbs().maxCoeff() > kMaxCoordinate) return {};
  return p;
}

std::optional<PageMessage> hello_in(const Parsed& value) {
  const auto found = value.is_object() ? value.find("token") : value.end();
  if (!value.is_object() || found == value.end()) return {};
  if (const auto token = name_in(*found)) return PageHello{*token};
  return {};
}

std::optional<PageMessage> want_in(const Parsed& value) {
  const auto found = value.is_object() ? value.find("field") : value.end();
  if (!value.is_object() || found == value.end()) return {};
  if (found->is_null()) return PageWant{};
  if (const auto field = name_in(*found)) return PageWant{*field};
  return {};
}

std::optional<PageMessage> pointer_in(const Parsed& value) {
  if (!value.is_object()) return {};
  const auto tool = number_in(value, "tool", kMaxTools - 1), buttons = number_in(value, "buttons", 0xffff),
             number = number_in(value, "number", std::uint64_t{1} << 53);
  const auto p_W = place_in(value);
  if (!tool || !buttons || !number || !p_W) return {};
  return PagePointer{static_cast<std::uint8_t>(*tool), *p_W, static_cast<std::uint16_t>(*buttons), *number};
}

}  // namespace

std::optional<PageMessage> read_page_message(std::string_view text) {
  if (text.size() > kLongestPageMessage || !is_shallow(text)) return {};
  const Parsed message = Parsed::parse(text, nullptr, false);
  if (!message.is_object() || message.size() != 1) return {};
  const std::string& key = message.begin().key();
  const Parsed& value = message.begin().value();
  if (key == "hello") return hello_in(value);
  if (key == "want") return want_in(value);
  if (key == "shown" && value.is_number_unsigned() && value.get<std::uint64_t>() <= 0xffffffff)
    return PageShown{value.get<std::uint32_t>()};
  if (key == "pause" && value.is_boolean()) return PagePause{value.get<bool>()};
  if (key == "step" && value.is_number_unsigned() && value.get<std::uint64_t>() == 1) return PageStep{};
  if (key == "pointer") return pointer_in(value);
  if (key == "choose") {
    if (const auto scene = name_in(value)) return PageChoose{*scene};
  }
  return {};
}

}  // namespace palpate::sim
