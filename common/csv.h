#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace palpate {

/// Reads the named columns of a comma-separated file whose first line (after lines that begin with '#') holds
/// the column names. Returns one vector per asked column, all of the same length, at least one row. Throws
/// `Error` with file and line for a missing column (nearest name suggested), a short row, or a cell that is
/// not a finite number.
std::vector<std::vector<double>> read_csv_columns(const std::filesystem::path& file,
                                                  std::span<const std::string> columns);

/// True if the file's header names this column. Throws `Error` where there is no such file.
bool has_csv_column(const std::filesystem::path& file, const std::string& column);

}  // namespace palpate
