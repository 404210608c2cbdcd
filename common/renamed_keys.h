#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string_view>

namespace palpate {

/// Returns the name that a key of scene and client files had in the release before; empty where it is the
/// same. Files may use it for one release more.
std::string_view former_name(std::string_view key) noexcept;

/// Adds to a report each renamed key under its former name too, for one release, and `deprecated_keys`, which
/// gives the name of each from now on. O(size of the report).
void add_former_keys(nlohmann::ordered_json& report);

}  // namespace palpate
