#include "haptic_client/session/client_config.h"

#include "common/error.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using namespace palpate::client;

TEST_CASE("an empty client file means the defaults, and the file that ships is read") {
  const test::TemporaryFolder folder;
  const ClientConfig config = read_client_config(folder.write("c.toml", ""));
  CHECK(config.server == "127.0.0.1:45130");
  CHECK(config.rate_hz == 500);
  CHECK_FALSE(config.device.trajectory);
  CHECK(read_client_config(test::source_dir() + "/configs/clients/liver_paper.toml").device.trajectory);
}

TEST_CASE(
    "the chosen law is scored with those that the file lists, once, and with none where it lists none") {
  const test::TemporaryFolder folder;
  const auto scored = [&](const std::string& text, const std::string& method) {
    ClientConfig config = read_client_config(folder.write("c.toml", text));
    if (!method.empty()) config.method = method;
    return config.scored_laws();
  };
  using Laws = std::vector<std::string>;
  CHECK(scored("", "") == Laws{"constant", "linear_time", "linear_position", "best_recent"});
  CHECK(scored("score = [\"constant\"]", "tangent") == Laws{"constant", "tangent"});
  CHECK(scored("score = [\"tangent\", \"constant\"]", "tangent") == Laws{"tangent", "constant"});
  CHECK(scored("score = []", "tangent").empty());
}

TEST_CASE("a Falcon's force fades at frozen encoders where its table says when") {
  const test::TemporaryFolder folder;
  const auto fade = [&](const std::string& text) {
    return read_client_config(folder.write("c.toml", text)).device.falcon.frozen_fade;
  };
  CHECK(fade("") == 0);
  CHECK(fade("[falcon]\nfrozen_fade = 10\n") == 10);
  CHECK_THROWS_WITH(fade("[falcon]\nfrozen_fade = 0.1\n"), Catch::Contains("c.toml:2"));
}

TEST_CASE("a SpaceMouse: its table is read, and the file that ships begins above the liver") {
  const test::TemporaryFolder folder;
  const ClientConfig config =
      read_client_config(folder.write("c.toml", "[spacemouse]\nspeed = 0.001\nreach = 1\n"));
  CHECK(config.device.spacemouse.speed == 0.001);
  CHECK(config.device.spacemouse.reach == 1);
  for (const char* wrong : {"speed = 2", "speed = 0", "reach = 1.1", "force = 1"})
    CHECK_THROWS_AS(read_client_config(folder.write("c.toml", std::string("[spacemouse]\n") + wrong)), Error);
  const ClientConfig shipped = read_client_config(test::source_dir() + "/configs/clients/spacemouse.toml");
  CHECK(shipped.device.name == "spacemouse");
  CHECK(shipped.workspace.to_world(Vec3::Zero()) == Vec3(-0.03, 0.09, 0.01));
}

TEST_CASE("a simulated hand that its sub-steps cannot follow is refused, with what would do") {
  const test::TemporaryFolder folder;
  const auto read = [&](const std::string& keys) {
    return read_client_config(folder.write("c.toml", "[operator]\n" + keys));
  };
  CHECK_THROWS_WITH(read("mass = 0.05\nhand_damping = 500\n"), Catch::Contains("take a larger `mass`"));
  CHECK_NOTHROW(read("mass = 0.3\nhand_damping = 500\n"));
  CHECK_NOTHROW(read("mass = 0.01\nhand_stiffness = 1e5\n"));
}

TEST_CASE("a motion told in the world reaches the same place through any workspace") {
  const test::TemporaryFolder folder;
  folder.write("m.csv", "t_s,x_m,y_m,z_m\n0,10,20,30\n1,10,20,30\n");
  const ClientConfig config =
      read_client_config(folder.write("c.toml",
                                      "[trajectory]\nfile = \"m.csv\"\nscale = 0.001\noffset = [1, 0, "
                                      "0]\n[workspace]\nscale = 2\noffset = [0, 5, 0]\n"));
  const Vec3 p_D = Trajectory(*config.device.trajectory).at(0.5);
  CHECK((config.workspace.to_world(p_D) - Vec3(1.010, 0.020, 0.030)).norm() < 1e-12);
}

TEST_CASE("axes of the workspace: a rotation, and nothing else") {
  const test::TemporaryFolder folder;
  const auto axes = [&](const std::string& names) {
    return read_client_config(folder.write("c.toml", "[workspace]\naxes = [" + names + "]\n")).workspace.axes;
  };
  Mat3 expected;
  expected << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  CHECK(axes("\"x\", \"-z\", \"y\"") == expected);
  CHECK_THROWS_WITH(axes("\"x\", \"y\", \"-z\""), Catch::Contains("c.toml:2") && Catch::Contains("mirror"));
  CHECK_THROWS_WITH(axes("\"x\", \"y\", \"y\""), Catch::Contains("once each"));
  CHECK_THROWS_WITH(axes("\"x\", \"y\", \"up\""), Catch::Contains("\"up\" is no axis"));
}

TEST_CASE("a motion told in the world reaches the same place and orientation through turned axes") {
  const test::TemporaryFolder folder;
  folder.write("m.csv",
               "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0.01,0.02,0.03,0,0.6,0.8,0\n1,0.01,0.02,0.03,0,0.6,0.8,0\n");
  const ClientConfig config = read_client_config(folder.write(
      "c.toml",
      "[trajectory]\nfile = \"m.csv\"\n[workspace]\naxes = [\"x\", \"-z\", \"y\"]\noffset = [0, 5, "
      "0]\n"));
  const Vec3 p_D = Trajectory(*config.device.trajectory).at(0.5);
  CHECK((config.workspace.to_world(p_D) - Vec3(0.01, 0.02, 0.03)).norm() < 1e-12);
  const Quat q_D = Trajectory(*config.device.trajectory).orientation_at(0.5);
  CHECK((Quat(config.workspace.axes) * q_D).angularDistance(Quat(0, 0.6, 0.8, 0)) < 1e-7);
}

TEST_CASE("keys of a recorded motion: read with their ranges, `columns` without time where a rate is told") {
  const test::TemporaryFolder folder;
  const auto read = [&](const std::string& keys) {
    return *read_client_config(folder.write("c.toml", "[trajectory]\nfile = \"m.csv\"\n" + keys))
                .device.trajectory;
  };
  const TrajectorySettings motion =
      read("time_scale = 1e-3\ngap = 0.5\nscale = 0.01\naxes = [\"x\", \"z\", \"-y\"]\n");
  CHECK(motion.time_scale == 1e-3);
  CHECK(motion.gap == 0.5);
  CHECK(motion.scale == 0.01);
  CHECK(motion.axes * Vec3(1, 2, 3) == Vec3(1, 3, -2));
  CHECK(read("").columns.empty());
  CHECK(read("rate_hz = 60\ncolumns = [\"a\", \"b\", \"c\"]\n").rate_hz == 60);
  for (const char* const wrong :
       {"time_scale = 0", "gap = 0", "rate_hz = 0", "columns = [\"a\", \"b\", \"c\"]",
        "rate_hz = 60\ntime_scale = 1", "rate_hz = 60\ncolumns = [\"t\", \"a\", \"b\", \"c\"]",
        "axes = [\"x\", \"y\", \"-z\"]"}) {
    CAPTURE(wrong);
    CHECK_THROWS_WITH(read(wrong), Catch::Contains("c.toml:"));
  }
}
