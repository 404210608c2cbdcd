#include "common/renamed_keys.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

struct Renamed {
  std::string_view former, name;
};

constexpr std::array kInFiles{Renamed{"share", "fraction"}, Renamed{"rest_modes", "condensed_modes"}};
constexpr std::array kInReports{Renamed{"felt", "rendered"},
                                Renamed{"shares", "fractions"},
                                Renamed{"wild", "implausible"},
                                Renamed{"left_out", "omitted"},
                                Renamed{"kept", "stored"},
                                Renamed{"what_to_look_at", "what_to_check"},
                                Renamed{"tetrahedra_left", "tetrahedra_remaining"},
                                Renamed{"farthest_m", "furthest_m"},
                                Renamed{"parted_m2", "separated_m2"},
                                Renamed{"mean_parted_distance_m", "mean_separated_distance_m"},
                                Renamed{"felt_error_percent", "rendered_error_percent"}};

std::string_view former_name_in(std::span<const Renamed> table, std::string_view key) {
  const auto row = std::ranges::find(table, key, &Renamed::name);
  return row == table.end() ? std::string_view() : row->former;
}

/// Adds them below `json`, and to `deprecated` those that there are.
void add_to(Json& json, Json& deprecated) {
  if (json.is_array()) {
    for (Json& item : json) add_to(item, deprecated);
  } else if (json.is_object()) {
    Json with = Json::object();
    for (auto& [key, value] : json.items()) {
      add_to(value, deprecated);
      const std::string former(former_name_in(kInReports, key));
      if (!former.empty()) deprecated[former] = key;
      if (!former.empty()) with[former] = value;
      with[key] = std::move(value);
    }
    json = std::move(with);
  }
}

}  // namespace

std::string_view former_name(std::string_view key) noexcept {
  return former_name_in(kInFiles, key);
}

void add_former_keys(Json& report) {
  Json deprecated = Json::object();
  add_to(report, deprecated);
  if (report.is_object() && !deprecated.empty()) report["deprecated_keys"] = std::move(deprecated);
}

}  // namespace palpate
