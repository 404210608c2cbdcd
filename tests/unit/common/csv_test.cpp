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

TEST_CASE(
    "the same numbers in other dialects: separators, decimal comma, plus, byte order mark, blanks first") {
  const palpate::test::TemporaryFolder folder;
  for (const char* const text :
       {"t_s;x_m\n0;1,5\n+5,0e-1;-2\n", "t_s\tx_m\r\n0\t1.5\r\n0.5\t-2\r\n", "t_s  x_m\n 0   1.5 \n+.5 -2\n",
        "\n \nt_s,x_m\n0,1.5\n0.5,-2\n", "\xEF\xBB\xBF\n\nt_s,x_m\n0,1.5\n0.5,-2\n",
        "# of a pump\n# t_s,x_m\n0,+1.5\n5e-1,-2e+00\n", "% t_s x_m\n0 1.5\n0.5 -2\n",
        "\"t_s\",\"x_m\",\n0,1.5,\n0.5,-2,\n"}) {
    CAPTURE(text);
    const auto columns = palpate::read_csv_columns(folder.write("a.csv", text), kColumns);
    CHECK(columns[0] == std::vector<double>{0, 0.5});
    CHECK(columns[1] == std::vector<double>{1.5, -2});
  }
}

TEST_CASE("an empty cell between tabs keeps its column") {
  const palpate::test::TemporaryFolder folder;
  const auto file = folder.write("a.csv", "note\tt_s\tx_m\n\t0\t1\nend\t1\t2\n");
  CHECK(palpate::read_csv_columns(file, kColumns)[1] == std::vector<double>{1, 2});
}

TEST_CASE("numbers without names, and more cells than names, are refused with what to write") {
  CHECK(error_of("0,1\n1,2\n").find(":1: numbers without the names of their 2 columns") == 0);
  CHECK(error_of("# made by hand\n0,1\n").find(":2: numbers without the names") == 0);
  CHECK(error_of("t_s,x_m\n0,5,1,5\n").find(":2: 4 cells under 2 column names; a comma as decimal") == 0);
  CHECK(error_of("t_s,x_m\n0,++1\n").find(":2: column x_m holds \"++1\"") == 0);
}
