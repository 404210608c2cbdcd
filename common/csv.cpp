#include "common/csv.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include "common/error.h"
#include "common/text.h"

namespace palpate {
namespace {

std::string trimmed(std::string_view cell) {
  const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '"'; };
  while (!cell.empty() && is_space(cell.front())) cell.remove_prefix(1);
  while (!cell.empty() && is_space(cell.back())) cell.remove_suffix(1);
  return std::string(cell);
}

std::vector<std::string> split(std::string_view line) {
  std::vector<std::string> cells;
  for (std::size_t from = 0;;) {
    const std::size_t comma = line.find(',', from);
    cells.push_back(trimmed(line.substr(from, comma - from)));
    if (comma == std::string_view::npos) return cells;
    from = comma + 1;
  }
}

double parse_cell(const std::string& cell, const std::string& where, const std::string& column) {
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc{} || end != cell.data() + cell.size() || !std::isfinite(value)) {
    fail("{}: column {} holds \"{}\", expected a finite number", where, column, cell);
  }
  return value;
}

std::vector<std::size_t> find_columns(const std::vector<std::string>& header,
                                      std::span<const std::string> columns, const std::string& where) {
  std::vector<std::size_t> indices;
  for (const std::string& column : columns) {
    const auto found = std::ranges::find(header, column);
    if (found == header.end()) fail("{}: no column \"{}\"{}", where, column, suggestion(column, header));
    indices.push_back(static_cast<std::size_t>(found - header.begin()));
  }
  return indices;
}

std::ifstream open_csv(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) fail("{}: no such file", file.string());
  std::ifstream in(file);
  if (!in) fail("{}: cannot be read; check its permissions", file.string());
  return in;
}

/// A line to be read; without the byte order mark of the first.
bool next_line(std::ifstream& in, int& number, std::string& line) {
  while (std::getline(in, line)) {
    if (++number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    if (!trimmed(line).empty() && line.front() != '#') return true;
  }
  return false;
}

}  // namespace

bool has_csv_column(const std::filesystem::path& file, const std::string& column) {
  std::ifstream in = open_csv(file);
  std::string line;
  int number = 0;
  if (!next_line(in, number, line)) return false;
  const std::vector<std::string> header = split(line);
  return std::ranges::find(header, column) != header.end();
}

std::vector<std::vector<double>> read_csv_columns(const std::filesystem::path& file,
                                                  std::span<const std::string> columns) {
  std::ifstream in = open_csv(file);
  std::vector<std::vector<double>> values(columns.size());
  std::vector<std::size_t> indices;
  std::string line;
  for (int number = 0; next_line(in, number, line);) {
    const std::string where = fmt::format("{}:{}", file.string(), number);
    const std::vector<std::string> cells = split(line);
    if (indices.empty()) {
      indices = find_columns(cells, columns, where);
      continue;
    }
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (indices[i] >= cells.size()) fail("{}: the row ends before column {}", where, columns[i]);
      values[i].push_back(parse_cell(cells[indices[i]], where, columns[i]));
    }
  }
  if (values.empty() || values.front().empty()) {
    fail("{}: no rows; expected a line of column names and rows of numbers", file.string());
  }
  return values;
}

}  // namespace palpate
