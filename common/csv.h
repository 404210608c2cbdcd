#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Table of numbers in a text file: a line of column names, then a row of numbers a line. Cells stand between
/// commas, semicolons, tabs or blanks, as the line of names shows; where no comma separates, one may be the
/// decimal mark. Lines that begin with '#' or '%' are comments, but for the last one above the numbers, where
/// no other line names the columns (numpy.savetxt). Set-up only.
class CsvTable {
 public:
  /// Reads the lines. Throws `Error` for a file that cannot be read, or names no columns.
  explicit CsvTable(const std::filesystem::path& file);

  const std::vector<std::string>& names() const { return names_; }
  bool has(std::string_view column) const;
  std::size_t rows() const { return rows_.size(); }
  /// Returns the named columns, each with `rows()` numbers, at least one. Throws `Error` with file and line
  /// for a missing column (nearest name suggested), a row of another length, or a cell that is not a finite
  /// number.
  std::vector<std::vector<double>> columns(std::span<const std::string> names) const;
  /// "FILE:LINE" of a row, from 0, and of the column names.
  std::string where(std::size_t row) const;
  std::string where_names() const;

 private:
  struct Line {
    int number;
    std::string text;
  };
  void read_names(const std::vector<Line>& comments);
  std::string at(const Line& line) const;
  std::size_t index_of(const std::string& column) const;
  std::vector<std::string_view> cells_of(const Line& row) const;

  std::string file_;
  Line head_{};  // the column names
  char separator_ = ',';
  std::vector<std::string> names_;
  std::vector<Line> rows_;
};

/// Returns the named columns of `file`, as `CsvTable::columns`.
std::vector<std::vector<double>> read_csv_columns(const std::filesystem::path& file,
                                                  std::span<const std::string> columns);

}  // namespace palpate
