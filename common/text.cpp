#include "common/text.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

#include "common/error.h"

namespace palpate {

int edit_distance(std::string_view a, std::string_view b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    int diagonal = row[0];
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

std::string two_figures(double value) {
  return std::abs(value) < 99.5 ? fmt::format("{:.2g}", value) : fmt::format("{:.0f}", value);
}

std::string suggestion(std::string_view name, std::span<const std::string> candidates) {
  if (candidates.empty()) return {};
  const auto nearest = std::min_element(
      candidates.begin(), candidates.end(),
      [&](const auto& a, const auto& b) { return edit_distance(name, a) < edit_distance(name, b); });
  const int far = std::max<int>(2, static_cast<int>(name.size()) / 2);
  if (edit_distance(name, *nearest) <= far) return fmt::format("; did you mean \"{}\"?", *nearest);
  return fmt::format("; known: {}", fmt::join(candidates, ", "));
}

void fail_unknown_name(std::string_view name, std::string_view what, std::string_view where,
                       std::span<const std::string> known) {
  constexpr std::size_t kFew = 8;  // names that fit in a line
  std::string also = suggestion(name, known);
  if (also.ends_with('?') && known.size() <= kFew) also += fmt::format(" known: {}", fmt::join(known, ", "));
  fail("{}: unknown {} \"{}\"{}", where, what, name, also);
}

std::string help_row(std::string_view name, std::string_view summary) {
  return fmt::format("  {:<24}{}\n", name, summary);
}

}  // namespace palpate
