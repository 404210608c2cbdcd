#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Levenshtein distance of two short names. O(|a| |b|).
int edit_distance(std::string_view a, std::string_view b);

/// `; did you mean "X"?` for the candidate nearest to `name`, or `; known: a, b, c` when none is near.
std::string suggestion(std::string_view name, std::span<const std::string> candidates);

/// A number with two figures, or all those before the point: "0.24", "3.5", "189".
std::string two_figures(double value);

/// The row called `name` in a registry table (any range of structs with a `name` member). Throws `Error` that
/// says `what` was looked up, where it was asked for, and the nearest known name.
template <class Table>
const auto& find_row(const Table& table, std::string_view name, std::string_view what,
                     std::string_view where);

/// "  NAME   what it is", a line for each row of a registry table with a `name` and a `summary`, for help
/// texts.
template <class Table>
std::string help_rows(const Table& table);

[[noreturn]] void fail_unknown_name(std::string_view name, std::string_view what, std::string_view where,
                                    std::span<const std::string> known);

std::string help_row(std::string_view name, std::string_view summary);

template <class Table>
std::string help_rows(const Table& table) {
  std::string text;
  for (const auto& row : table) text += help_row(row.name, row.summary);
  return text;
}

template <class Table>
const auto& find_row(const Table& table, std::string_view name, std::string_view what,
                     std::string_view where) {
  for (const auto& row : table) {
    if (row.name == name) return row;
  }
  std::vector<std::string> known;
  for (const auto& row : table) known.emplace_back(row.name);
  fail_unknown_name(name, what, where, known);
}

}  // namespace palpate
