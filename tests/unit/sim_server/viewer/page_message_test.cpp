#include "sim_server/viewer/page_message.h"

#include "tests/support/catch.h"

using namespace palpate::sim;

TEST_CASE("viewer: what a page may say") {
  const auto hello = read_page_message(R"({"hello": {"token": "ab12"}})");
  REQUIRE(hello);
  CHECK(std::get<PageHello>(*hello).token == "ab12");
  const auto want = read_page_message(R"({"want": {"field": "strain_energy"}})");
  REQUIRE(want);
  CHECK(std::get<PageWant>(*want).field == "strain_energy");
  CHECK(std::get<PageWant>(*read_page_message(R"({"want": {"field": null}})")).field.empty());
  CHECK(std::get<PageShown>(*read_page_message(R"({"shown": 4294967295})")).step == 4294967295);
  CHECK(std::get<PagePause>(*read_page_message(R"({"pause": true})")).paused);
  CHECK_FALSE(std::get<PagePause>(*read_page_message(R"({"pause": false})")).paused);
  CHECK(std::holds_alternative<PageStep>(*read_page_message(R"({"step": 1})")));
  CHECK(std::get<PageChoose>(*read_page_message(R"({"choose": "liver"})")).scene == "liver");
  const auto pointer =
      read_page_message(R"({"pointer": {"tool": 7, "p": [0.1, -2, 1e-3], "buttons": 3, "number": 12}})");
  REQUIRE(pointer);
  const auto& said = std::get<PagePointer>(*pointer);
  CHECK(said.tool == 7);
  CHECK(said.p_W.x() == 0.1);
  CHECK(said.p_W.y() == -2);
  CHECK(said.buttons == 3);
  CHECK(said.number == 12);
}

TEST_CASE("viewer: what it may not") {
  const std::string deep = R"({"want": )" + std::string(1000, '[') + std::string(1000, ']') + "}";
  const std::string long_name = R"({"choose": ")" + std::string(257, 'a') + "\"}";
  const std::string long_message = R"({"step": 1)" + std::string(kLongestPageMessage, ' ') + "}";
  const auto pointer = [](const std::string& p, const std::string& rest) {
    return R"({"pointer": {"p": )" + p + ", " + rest + "}}";
  };
  const std::string kRest = R"("tool": 0, "buttons": 0, "number": 1)";
  REQUIRE(read_page_message(pointer("[0, 0, 0]", kRest)));
  for (const std::string& text : {std::string(),
                                  std::string("{}"),
                                  std::string("[]"),
                                  std::string("null"),
                                  std::string("{\"hello\""),
                                  std::string(R"({"hello": {"token": 5}})"),
                                  std::string(R"({"hello": "token"})"),
                                  std::string(R"({"hello": {}})"),
                                  std::string(R"({"want": {}})"),
                                  std::string(R"({"want": {"field": 1}})"),
                                  std::string(R"({"want": []})"),
                                  std::string(R"({"pause": 1})"),
                                  std::string(R"({"step": 2})"),
                                  std::string(R"({"step": -1})"),
                                  std::string(R"({"shown": 4294967296})"),
                                  std::string(R"({"shown": -1})"),
                                  std::string(R"({"choose": 1})"),
                                  std::string(R"({"erase": true})"),
                                  std::string(R"({"pause": true, "step": 1})"),
                                  std::string("{\"choose\": \"\xff\xfe\"}"),
                                  deep,
                                  long_name,
                                  long_message,
                                  pointer("[0, 0]", kRest),
                                  pointer("[0, 0, 0, 0]", kRest),
                                  pointer("[0, 0, \"0\"]", kRest),
                                  pointer("[0, 0, 1001]", kRest),
                                  pointer("[0, 0, 1e999]", kRest),
                                  pointer("0", kRest),
                                  pointer("[0, 0, 0]", R"("tool": 8, "buttons": 0, "number": 1)"),
                                  pointer("[0, 0, 0]", R"("tool": -1, "buttons": 0, "number": 1)"),
                                  pointer("[0, 0, 0]", R"("tool": 0, "buttons": 65536, "number": 1)"),
                                  pointer("[0, 0, 0]", R"("tool": 0, "buttons": 0, "number": 1.5)"),
                                  pointer("[0, 0, 0]", R"("tool": 0, "buttons": 0)")}) {
    CAPTURE(text);
    CHECK_FALSE(read_page_message(text));
  }
}
