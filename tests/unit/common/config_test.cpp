#include "common/config.h"

#include "common/error.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using palpate::Config;
using palpate::Error;
using palpate::Vec3;

namespace {

const palpate::test::TemporaryFolder& folder() {
  static const palpate::test::TemporaryFolder shared;
  return shared;
}

Config config_of(const std::string& text) {
  return Config::read(folder().write("test.toml", text));
}

/// What the error of `use` says, without the folder.
template <class Use>
std::string error_of(Use use) {
  try {
    use();
  } catch (const Error& e) {
    CHECK(e.exit_code() == 2);
    const std::string text = e.what(), file = (folder().path() / "test.toml").string();
    return text.starts_with(file) ? text.substr(file.size()) : text;
  }
  return "no error";
}

}  // namespace

TEST_CASE("values, defaults, tables and paths") {
  const Config c = config_of(
      "a = 1.5\nn = 3\ns = \"x\"\nv = [1, 2.5, -3]\nf = \"sub/m.msh\"\n[t]\nb = "
      "[[0,0,0],[1,2,3]]\n[[l]]\n[[l]]\n");
  CHECK(c.number("a", {}) == 1.5);
  CHECK(c.number("n", {}) == 3);
  CHECK(c.integer("n", {}) == 3);
  CHECK(c.number("absent", {}, 7) == 7);
  CHECK(c.text("s") == "x");
  CHECK(c.vector("v", {}) == Vec3(1, 2.5, -3));
  CHECK(c.file("f") == folder().path() / "sub/m.msh");
  CHECK(c.table("t")->box("b").second == Vec3(1, 2, 3));
  CHECK(c.tables("l").size() == 2);
  CHECK_FALSE(c.table("nothing"));
  CHECK_NOTHROW(c.reject_unknown());
}

TEST_CASE("every wrong value names line, key and what was expected") {
  CHECK(error_of([] { config_of("a = 1").number("b", {}); }) == ":1: missing key `b`");
  CHECK(error_of([] { config_of("c = 1\nradios = 1").number("radius", {}); }) ==
        ":2: unknown key `radios`; did you mean \"radius\"?");
  CHECK(error_of([] { config_of("\na = \"1\"").number("a", {.unit = "Pa"}); }) ==
        ":2: `a` must be a number (Pa)");
  CHECK(error_of([] {
          config_of("a = 7").number("a", {0, 5, "m"});
        }) == ":1: `a` must be between 0 and 5 (m), not 7");
  CHECK(error_of([] {
          config_of("a = nan").number("a", {0, 5, "m"});
        }) == ":1: `a` must be between 0 and 5 (m), not nan");
  CHECK(error_of([] { config_of("a = 1.5").integer("a", {}); }) == ":1: `a` must be a whole number");
  CHECK(error_of([] { config_of("a = 1").text("a"); }) == ":1: `a` must be text in quotes");
  CHECK(error_of([] { config_of("a = [1, 2]").vector("a", {.unit = "m"}); }) ==
        ":1: `a` must be three numbers [x, y, z] in m");
  CHECK(error_of([] {
          config_of("[t]\nb = [[1,0,0],[0,1,1]]").table("t")->box("b");
        }).starts_with(":2: `[t] b` must be [minimum"));
  CHECK(error_of([] {
          config_of("[[t]]\n[t.u]\n[[t.u.v]]")
              .tables("t")
              .front()
              .table("u")
              ->tables("v")
              .front()
              .number("a", {});
        }) == ":3: missing key `[[t.u.v]] a`");
  CHECK(error_of([] { config_of("t = 1").table("t"); }) == ":1: `t` must be a table `[t]`");
  CHECK(error_of([] { config_of("[t]").tables("t"); }) ==
        ":1: `t` must be one or more tables `[[t]]` (two brackets)");
  CHECK(error_of([] { config_of("a = ["); }).starts_with(":1: not TOML: "));
  CHECK(error_of([] { Config::read(folder().path() / "none.toml"); }).ends_with("none.toml: no such file"));
}

TEST_CASE("an unknown key is refused with the nearest known one") {
  const auto use = [] {
    const Config c = config_of("[material]\nyoung_modulus = 1\npoison_ratio = 0.4\n");
    const Config m = *c.table("material");
    m.number("young_modulus", {});
    m.number("poisson_ratio", {}, 0.3);
    m.reject_unknown();
  };
  CHECK(error_of(use) == ":3: unknown key `[material] poison_ratio`; did you mean \"poisson_ratio\"?");
}

TEST_CASE("a key under its former name counts as the key, unless both are there") {
  const Config former = config_of("share = 0.25");
  CHECK(former.has("fraction"));
  CHECK(former.number("fraction", {}) == 0.25);
  CHECK(former.where("fraction") == (folder().path() / "test.toml").string() + ":1");
  CHECK_NOTHROW(former.reject_unknown());
  CHECK(error_of([] {
          config_of("\nshare = 2").number("fraction", {0, 1});
        }) == ":2: `fraction` must be between 0 and 1, not 2");
  const Config both = config_of("fraction = 0.5\nshare = 0.25");
  CHECK(both.number("fraction", {}) == 0.5);
  CHECK(error_of([&] { both.reject_unknown(); }).starts_with(":2: unknown key `share`"));
}
