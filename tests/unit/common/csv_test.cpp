#include "common/csv.h"

#include <array>

#include "common/error.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

namespace {
const std::array<std::string, 2> kColumns{"t_s", "x_m"};

std::string error_of(const std::string& text) {
  const palpate::test::TemporaryFolder folder;
  const auto file = folder.write("a.csv", text);
  try {
    palpate::read_csv_columns(file, kColumns);
  } catch (const palpate::Error& e) {
    return std::string(e.what()).substr(file.string().size());
  }
  return "no error";
}
}  // namespace

TEST_CASE("named columns are found in any order, past comments and blank lines") {
  const palpate::test::TemporaryFolder folder;
  const auto file = folder.write("a.csv", "# a comment\n\nx_m, y ,t_s\r\n1,9,0\n2.5e-3,9,0.5\n");
  const auto columns = palpate::read_csv_columns(file, kColumns);
  CHECK(columns[0] == std::vector<double>{0, 0.5});
  CHECK(columns[1] == std::vector<double>{1, 2.5e-3});
}

TEST_CASE("a bad row is named by its line") {
  CHECK(error_of("t_s,x_m\n0,1\n1,zero\n") == ":3: column x_m holds \"zero\", expected a finite number");
  CHECK(error_of("t_s,x_m\n0,nan\n") == ":2: column x_m holds \"nan\", expected a finite number");
  CHECK(error_of("t_s,x_m\n0\n") == ":2: the row ends before column x_m");
  CHECK(error_of("t_s,x_mm\n0,1\n") == ":1: no column \"x_m\"; did you mean \"x_mm\"?");
  CHECK(error_of("t_s,x_m\n").ends_with("no rows; expected a line of column names and rows of numbers"));
}
