#pragma once
/// A test case for each row of a registry: rows run side by side, and one that fails is told by its name.
#include <string>

#include "tests/support/catch.h"

namespace palpate::test {

template <class Row>
class RowTest : public Catch::ITestInvoker {
 public:
  RowTest(const Row& row, void (*body)(const Row&)) : row_(row), body_(body) {}
  void invoke() const override { body_(row_); }

 private:
  Row row_;
  void (*body_)(const Row&);
};

/// Puts "contract: TITLE: ROW" among the tests for each of `rows`, which have a `name`.
template <class Row, class Rows>
bool register_rows(const std::string& title, const Rows& rows, void (*body)(const Row&),
                   const Catch::SourceLineInfo& where) {
  for (const Row& row : rows) {
    std::string name;
    if constexpr (requires { row.name(); }) {
      name = row.name();
    } else {
      name = row.name;
    }
    name = "contract: " + title + ": " + name;
#if __has_include(<catch2/catch_all.hpp>)
    Catch::AutoReg(Catch::Detail::unique_ptr<Catch::ITestInvoker>(new RowTest<Row>(row, body)), where, "",
                   Catch::NameAndTags{name});
#else
    Catch::AutoReg(new RowTest<Row>(row, body), where, "", Catch::NameAndTags{name});
#endif
  }
  return true;
}

}  // namespace palpate::test

#define PALPATE_CONTRACT_BY(body, title, Row, row, rows)                              \
  static void body(const Row& row);                                                   \
  [[maybe_unused]] static const bool body##_registered =                              \
      palpate::test::register_rows<Row>(title, rows, &body, CATCH_INTERNAL_LINEINFO); \
  static void body(const Row& row)
#define PALPATE_CONTRACT_AT(line, title, Row, row, rows) \
  PALPATE_CONTRACT_BY(contract_of_line_##line, title, Row, row, rows)
#define PALPATE_CONTRACT(line, title, Row, row, rows) PALPATE_CONTRACT_AT(line, title, Row, row, rows)
/// CONTRACT("what rows must do", Row, row, rows()) { ... }: like TEST_CASE, with one of the rows as `row`.
#define CONTRACT(title, Row, row, rows) PALPATE_CONTRACT(__LINE__, title, Row, row, rows)
