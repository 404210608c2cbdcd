#include "common/trajectory.h"

#include "common/error.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;

namespace {

Trajectory read(const std::string& rows, bool repeat = false) {
  test::TemporaryFolder folder;
  return Trajectory({.file = folder.write("motion.csv", rows), .repeat = repeat});
}

}  // namespace

TEST_CASE("a motion presses its buttons from each row on, before the first and after the last as these say") {
  const Trajectory motion = read("t_s,x_m,y_m,z_m,buttons\n1,0,0,0,0\n2,1,0,0,5\n3,2,0,0,65535\n");
  CHECK(motion.buttons_at(-1) == 0);
  CHECK(motion.buttons_at(0.999) == 0);
  CHECK(motion.buttons_at(1) == 5);
  CHECK(motion.buttons_at(1.999) == 5);
  CHECK(motion.buttons_at(2) == 65535);
  CHECK(motion.buttons_at(100) == 65535);
  CHECK(motion.at(0.5) == Vec3(0.5, 0, 0));
}

TEST_CASE("a motion without that column presses none, and one that repeats presses them again") {
  CHECK(read("t_s,x_m,y_m,z_m\n0,0,0,0\n1,1,0,0\n").buttons_at(0.5) == 0);
  CHECK(Trajectory({0}, {Vec3::Zero()}).buttons_at(1) == 0);
  const Trajectory again = read("t_s,x_m,y_m,z_m,buttons\n0,0,0,0,1\n1,1,0,0,2\n2,0,0,0,0\n", true);
  CHECK(again.buttons_at(2.5) == 1);
  CHECK(again.buttons_at(3.5) == 2);
}

TEST_CASE("buttons that are no bits are one line with file, column and value") {
  for (const char* const wrong : {"-1", "0.5", "65536"}) {
    CAPTURE(wrong);
    CHECK_THROWS_WITH(read(std::string("t_s,x_m,y_m,z_m,buttons\n0,0,0,0,") + wrong + "\n"),
                      Catch::Matchers::Contains("motion.csv:2: column buttons holds") &&
                          Catch::Matchers::Contains("0 to 65535"));
  }
}
