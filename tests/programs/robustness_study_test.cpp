// `studies robustness`, behind `scripts/study robustness`: rows of a few quick cells.
#include "tests/support/catch.h"
#include "tests/support/programs.h"

using namespace palpate::test;

namespace {

nlohmann::json row_of(const std::string& name, const std::string& model) {
  const auto row = nlohmann::json::parse(output_of("studies", {"robustness", "--quick", name, model}, 0, 60));
  CHECK(row.at("case") == name);
  CHECK(row.at("model") == model);
  CHECK(row.size() == 7);
  return row;
}

}  // namespace

TEST_CASE("robustness study: a cell that holds has an error against a reference, and a largest force") {
  const auto row = row_of("usual", "rigid");
  CHECK(row.at("outcome") == "stable");
  CHECK(row.at("error_percent").get<double>() < 1e-3);
  CHECK(row.at("max_force_newton").get<double>() == Approx(800 * 0.003).epsilon(1e-3));  // stiffness x depth
  CHECK(row.at("reference") == "closed form: stiffness x depth");
  CHECK(row_of("soft", "quasi_static").at("error_percent").get<double>() < 0.01);
}

TEST_CASE("robustness study: with friction of 10 a tool that is drawn does not slip") {
  const auto rigid = row_of("friction_10", "rigid");
  CHECK(rigid.at("outcome") == "stable");
  CHECK(rigid.at("max_force_newton").get<double>() ==
        Approx(800 * 0.005).epsilon(1e-3));  // 3 mm deep, 4 mm along
  const auto elastic = row_of("friction_10", "quasi_static");
  CHECK(elastic.at("outcome") == "stable");
  CHECK(elastic.at("error_percent").get<double>() < 0.01);
}

TEST_CASE("robustness study: where two facets may bear a tool, a cell says that it rests on the other") {
  const auto row = row_of("starts_deep", "implicit neo_hookean");
  CHECK(row.at("error_percent").get<double>() > 1);
  CHECK(row.at("reason").get<std::string>().find("more than one place to rest") != std::string::npos);
  CHECK(row_of("teleported", "quasi_static").at("reason") == "");
  CHECK(row_of("pinched", "tensor_mass").at("outcome") == "stable");
  CHECK(row_of("pinched", "quasi_static").at("reason") == "");
}

TEST_CASE(
    "robustness study: two tools pinch, hold and press, and hand over as Newton's third law and statics "
    "say") {
  for (const char* const model : {"quasi_static", "reduced"}) {
    const auto pinched = row_of("pinch_6_mm_fast", model);
    CHECK(pinched.at("outcome") == "stable");
    CHECK(pinched.at("error_percent").get<double>() < 1e-6);  // the body is its own mirror image
    const auto handed = row_of("hand_over", model);
    CHECK(handed.at("outcome") == "stable");
    CHECK(handed.at("error_percent").get<double>() < 0.01);
    CHECK(row_of("grasp_and_press", model).at("error_percent").get<double>() < 0.01);
  }
  CHECK(row_of("pinch_6_mm", "rigid").at("outcome") == "not_applicable");
}

TEST_CASE("robustness study: a refused cell says what to change, a flagged one how often it was") {
  const auto refused = row_of("hard", "tensor_mass");
  CHECK(refused.at("outcome") == "refused");
  CHECK(refused.at("reason").get<std::string>().find("sub-steps") != std::string::npos);
  CHECK(refused.at("error_percent").is_null());
  const auto flagged = row_of("nan_pose", "quasi_static");
  CHECK(flagged.at("outcome") == "flagged");
  CHECK(flagged.at("reason").get<std::string>().find("steps flagged") != std::string::npos);
  CHECK(row_of("scattered", "rigid").at("outcome") == "not_applicable");
}

TEST_CASE("robustness study: twice the same cell gives the same bytes, wrong use tells how, exit 2") {
  const std::vector<std::string> cell{"robustness", "--quick", "usual", "implicit neo_hookean"};
  CHECK(output_of("studies", cell, 0, 60) == output_of("studies", cell, 0, 60));
  CHECK(output_of("studies", {"robustness"}, 2).find("CASE") != std::string::npos);
  CHECK(output_of("studies", {"robustness", "usul", "rigid"}, 2).find("did you mean \"usual\"") !=
        std::string::npos);
}
