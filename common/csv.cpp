#include "common/csv.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>

#include "common/error.h"
#include "common/files.h"
#include "common/text.h"

namespace palpate {
namespace {

constexpr std::string_view kBlanks = " \r";  // around a line; a tab may stand for an empty cell

std::string_view trimmed(std::string_view cell, std::string_view of = " \t\r\"") {
  const std::size_t first = cell.find_first_not_of(of);
  if (first == std::string_view::npos) return {};
  return cell.substr(first, cell.find_last_not_of(of) + 1 - first);
}

/// Returns what separates the cells of a line: ' ' for any run of blanks.
char separator_of(std::string_view line) {
  for (const char separator : {';', '\t', ','}) {
    if (trimmed(line, kBlanks).find(separator) != std::string_view::npos) return separator;
  }
  return trimmed(line, kBlanks).find(' ') != std::string_view::npos ? ' ' : ',';
}

std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  line = trimmed(line, kBlanks);
  for (;;) {
    const std::size_t end = line.find(separator);
    cells.push_back(trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) return cells;
    line.remove_prefix(end + 1);
    if (separator == ' ') line = trimmed(line, kBlanks);
  }
}

/// Returns the number in a cell; nothing where there is none, or none that is finite.
std::optional<double> number_in(std::string_view cell, bool takes_comma) {
  std::string text(cell);
  if (takes_comma && text.find('.') == std::string::npos) {
    if (const std::size_t comma = text.find(','); comma != std::string::npos) text[comma] = '.';
  }
  const char* begin = text.c_str();
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') ++begin;  // from_chars takes no plus
  double value = 0;
  const char* const end = text.c_str() + text.size();
  const auto [stopped, error] = std::from_chars(begin, end, value);
  if (error != std::errc{} || stopped != end || !std::isfinite(value)) return {};
  return value;
}

std::ifstream open_csv(const std::filesystem::path& file) {
  require_file(file, "a file");
  std::ifstream in(file);
  if (!in) fail("{}: cannot be read; check its permissions", file.string());
  return in;
}

}  // namespace

CsvTable::CsvTable(const std::filesystem::path& file) : file_(file.string()) {
  std::ifstream in = open_csv(file);
  std::vector<Line> comments;
  Line line{0, {}};
  while (std::getline(in, line.text)) {
    if (++line.number == 1 && line.text.starts_with("\xEF\xBB\xBF")) line.text.erase(0, 3);
    const std::string_view text = trimmed(line.text);
    if (text.empty()) continue;
    if (text.front() != '#' && text.front() != '%')
      rows_.push_back(line);
    else if (rows_.empty())
      comments.push_back(line);
  }
  if (!rows_.empty()) read_names(comments);
  if (rows_.empty()) fail("{}: no rows; expected a line of column names and rows of numbers", file_);
}

/// Takes the column names from the first line, or from the last comment where numbers begin at once.
void CsvTable::read_names(const std::vector<Line>& comments) {
  head_ = rows_.front();
  separator_ = separator_of(head_.text);
  const std::vector<std::string_view> first = split(head_.text, separator_);
  if (!number_in(first.front(), separator_ != ',')) {
    names_.assign(first.begin(), first.end());
    rows_.erase(rows_.begin());
    return;
  }
  if (!comments.empty()) {
    const std::string_view text = trimmed(comments.back().text, " \t\r#%");
    const std::vector<std::string_view> names = split(text, separator_of(text));
    if (names.size() == first.size()) {
      head_ = comments.back();
      names_.assign(names.begin(), names.end());
      return;
    }
  }
  fail("{}: numbers without the names of their {} columns; write a line of names above, as t_s,x_m,y_m,z_m",
       at(head_), first.size());
}

bool CsvTable::has(std::string_view column) const {
  return std::ranges::find(names_, column) != names_.end();
}

std::string CsvTable::at(const Line& line) const {
  return fmt::format("{}:{}", file_, line.number);
}

std::string CsvTable::where(std::size_t row) const {
  return at(rows_[row]);
}

std::string CsvTable::where_names() const {
  return at(head_);
}

std::size_t CsvTable::index_of(const std::string& column) const {
  const auto found = std::ranges::find(names_, column);
  if (found == names_.end()) fail("{}: no column \"{}\"{}", at(head_), column, suggestion(column, names_));
  return static_cast<std::size_t>(found - names_.begin());
}

/// Returns the cells of a row; some programs end a row with a separator.
std::vector<std::string_view> CsvTable::cells_of(const Line& row) const {
  std::vector<std::string_view> cells = split(row.text, separator_);
  if (cells.size() > names_.size() && cells.back().empty()) cells.pop_back();
  if (cells.size() > names_.size())
    fail("{}: {} cells under {} column names; a comma as decimal mark needs semicolons between cells",
         at(row), cells.size(), names_.size());
  return cells;
}

std::vector<std::vector<double>> CsvTable::columns(std::span<const std::string> names) const {
  std::vector<std::size_t> indices;
  for (const std::string& name : names) indices.push_back(index_of(name));
  std::vector<std::vector<double>> values(names.size());
  for (const Line& row : rows_) {
    const std::vector<std::string_view> cells = cells_of(row);
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (indices[i] >= cells.size()) fail("{}: the row ends before column {}", at(row), names[i]);
      const std::string_view cell = cells[indices[i]];
      const auto value = number_in(cell, separator_ != ',');
      if (!value) fail("{}: column {} holds \"{}\", expected a finite number", at(row), names[i], cell);
      values[i].push_back(*value);
    }
  }
  return values;
}

std::vector<std::vector<double>> read_csv_columns(const std::filesystem::path& file,
                                                  std::span<const std::string> columns) {
  return CsvTable(file).columns(columns);
}

}  // namespace palpate
