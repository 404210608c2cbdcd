#include "common/renamed_keys.h"

#include <nlohmann/json.hpp>

#include "tests/support/catch.h"

using Json = nlohmann::ordered_json;

TEST_CASE("a report has renamed keys under both names, and names those that will go") {
  Json report = {{"tools", {{{"rendered", {{"law", "tangent"}}}, {"ticks", 3}}}}, {"wildcard", 1}};
  palpate::add_former_keys(report);
  CHECK(report ==
        Json{{"tools", {{{"felt", {{"law", "tangent"}}}, {"rendered", {{"law", "tangent"}}}, {"ticks", 3}}}},
             {"wildcard", 1},
             {"deprecated_keys", {{"felt", "rendered"}}}});
}

TEST_CASE("a report without renamed keys, or that is a list, gets no list of deprecated ones") {
  Json plain = {{"ticks", 3}}, rows = Json::array({{{"implausible", 1}}});
  palpate::add_former_keys(plain);
  palpate::add_former_keys(rows);
  CHECK(plain == Json{{"ticks", 3}});
  CHECK(rows == Json::array({{{"wild", 1}, {"implausible", 1}}}));
}
