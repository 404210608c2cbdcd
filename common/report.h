#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/histogram.h"

namespace palpate {

using Json = nlohmann::ordered_json;

/// {"p50": .., "p99": .., "p999": .., "max": ..} of a histogram of nanoseconds, divided by `unit_ns`
/// (1e3 for microseconds, 1e6 for milliseconds).
Json quantiles(const Histogram& histogram, double unit_ns);

/// Throws `Error` now, rather than after the run, if `file` could not be written.
void check_writable(const std::filesystem::path& file);

/// Writes `text` whole or not at all (a temporary file beside it, then rename). Throws `Error` (run time).
void write_whole(const std::filesystem::path& file, const std::string& text);

/// `write_whole` of a JSON document, indented.
void write_json(const std::filesystem::path& file, const Json& json);

}  // namespace palpate
