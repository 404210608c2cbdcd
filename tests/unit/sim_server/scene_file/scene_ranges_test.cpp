// Wrong values in a scene file: each is one line that names the file, its line, the key and what would do.
#include <algorithm>
#include <fmt/format.h>

#include "common/error.h"
#include "sim_server/models/deformation_models.h"
#include "sim_server/models/reduced.h"
#include "sim_server/scene_file/read_scene.h"
#include "sim_server/simulation/simulation.h"
#include "sim_server/tissue/rayleigh_damping.h"
#include "tests/support/catch.h"
#include "tests/support/column.h"
#include "tests/support/temporary_folder.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

std::string key_of(const std::string& line) {
  return line.substr(0, line.find(' '));
}

/// A scene in order, but for `wrong` in `section`: last there, and instead of what it says of the same key.
struct SceneWith {
  test::TemporaryFolder folder;
  std::string file;
  long line = 0;  // where `wrong` ends

  SceneWith(const std::string& section, const std::string& wrong, const std::string& model = "implicit") {
    folder.write("column.msh", test::column());
    std::string text;
    const auto add = [&](const std::string& head, const std::vector<std::string>& keys) {
      text += head.empty() ? "" : head + "\n";
      for (const std::string& key : keys) {
        if (head != section || key_of(key) != key_of(wrong)) text += key + "\n";
      }
      if (head != section) return;
      text += wrong;
      line = 1 + std::ranges::count(text, '\n');
      text += "\n";
    };
    add("", {"rate_hz = 30"});
    add("[mesh]", {"file = \"column.msh\""});
    add("[[fixed]]", {"box = [[-1, -1, -1], [1, 0, 1]]"});
    add("[material]", {"young_modulus = 1e4", "poisson_ratio = 0.3"});
    add("[deformation]",
        {fmt::format("model = \"{}\"", model), model == "spring" ? "spring_stiffness = [1, 1, 1]" : ""});
    add("[[tool]]", {"radius = 0.01"});
    file = folder.write("scene.toml", text).string();
  }
  /// What is said of it, without the name of the file; empty: nothing.
  std::string error(bool build = false) const {
    try {
      const Scene scene = read_scene(file);
      if (build) Simulation{scene};
    } catch (const Error& e) {
      CHECK(e.exit_code() == 2);
      const std::string said = e.what();
      REQUIRE(said.starts_with(file + ":"));
      CHECK(said.find('\n') == std::string::npos);
      return said.substr(file.size());
    }
    return "";
  }
};

struct Wrong {
  const char *section, *text, *key, *says, *model = "implicit";
};

void check_refused(const Wrong& wrong) {
  const SceneWith scene(wrong.section, wrong.text, wrong.model);
  const std::string said = scene.error();
  CAPTURE(wrong.section, wrong.text, wrong.model, said);
  CHECK(said.starts_with(fmt::format(":{}: ", scene.line)));
  CHECK(said.find(wrong.key) != std::string::npos);
  CHECK(said.find(wrong.says) != std::string::npos);
}

}  // namespace

TEST_CASE("a scene in order is read, and built by every model") {
  for (const DeformationModelRow& row : models_without_cutting())
    CHECK(SceneWith("[[tool]]", "friction = 0.3", std::string(row.name).c_str())
              .error(!row.takes<ReducedSettings>())
              .empty());
}

TEST_CASE("[deformation]: values out of range, and names that are none") {
  for (const Wrong& wrong : {
           Wrong{"[deformation]", "max_newton = 0", "max_newton", "between 1 and 100 (per step), not 0"},
           Wrong{"[deformation]", "max_newton = 101", "max_newton", "between 1 and 100"},
           Wrong{"[deformation]", "max_newton = 2.5", "max_newton", "a whole number"},
           Wrong{"[deformation]", "refresh_steps = 0", "refresh_steps", "between 1 and 1000 (steps)"},
           Wrong{"[deformation]", "refresh_steps = 1001", "refresh_steps", "between 1 and 1000"},
           Wrong{"[deformation]", "tolerance = 0", "tolerance", "between 1e-12 and 0.1"},
           Wrong{"[deformation]", "tolerance = 0.11", "tolerance", "between 1e-12 and 0.1"},
           Wrong{"[deformation]", "tolerance = nan", "tolerance", "between 1e-12 and 0.1"},
           Wrong{"[deformation]", "solver = \"gmres\"", "solver", "direct, quasi_newton"},
           Wrong{"[deformation]", "solver = 1", "solver", "text in quotes"},
           Wrong{"[deformation]", "integrator = \"bdf3\"", "integrator", "backward_euler, bdf2"},
           Wrong{"[deformation]", "rayleigh_mass = -1", "rayleigh_mass", "between 0 and 10000 (1/s)"},
           Wrong{"[deformation]", "rayleigh_stiffness = 1.1", "rayleigh_stiffness", "between 0 and 1 (s)"},
           Wrong{"[deformation]", "added_mass = 0.3", "added_mass", "between 0 and 0.2", "tensor_mass"},
           Wrong{"[deformation]", "added_mass = 0.1", "added_mass", "tensor_mass, hybrid", "implicit"},
           Wrong{"[deformation]", "stiffness = 0", "stiffness", "between 0.001 and 1000000 (N/m)", "rigid"},
           Wrong{"[deformation]", "stiffness = 2e6", "stiffness", "between 0.001 and 1000000", "rigid"},
           Wrong{"[deformation]", "spring_stiffness = [1, 0, 1]", "spring_stiffness", "between 0.001",
                 "spring"},
           Wrong{"[deformation]", "hardening_length = 0", "hardening_length", "between 0.0001 and 10 (m)",
                 "spring"},
           Wrong{"[deformation]", "model = \"jelly\"", "deformation model", "quasi_static"},
           Wrong{"[deformation]", "modes = 0", "modes", "between 1 and 1000 (modes)", "reduced"},
           Wrong{"[deformation]", "modes = 1001", "modes", "between 1 and 1000", "reduced"},
       })
    check_refused(wrong);
}

TEST_CASE("[cutting]: values out of range, and a scene in which nothing could be cut") {
  const std::string cuts = "cut_buttons = 1\n[cutting]\n",
                    plan = cuts + "[cutting.plan]\npoint = [0, 0, 0]\n";
  const std::string power = cuts + "power = 0", energy = cuts + "energy = 1", spot = cuts + "spot = 0",
                    piece = cuts + "smallest_piece = -1", wrong_key = cuts + "watts = 5",
                    normal = plan + "normal = [0, 0, 0]", within = plan + "normal = [1, 0, 0]\nwithin = 0",
                    tough = cuts + "toughness = -1", growth = cuts + "[cutting.growth]",
                    alone = cuts.substr(0, cuts.size() - 1);
  for (const Wrong& wrong : {
           Wrong{"[[tool]]", "cut_buttons = 0", "cut_buttons", "between 1 and 65535"},
           Wrong{"[[tool]]", "cut_buttons = 1", "cut_buttons", "no [cutting] that says how"},
           Wrong{"[[tool]]", "[cutting]", "no [[tool]] cuts", "give one `cut_buttons`"},
           Wrong{"[[tool]]", alone.c_str(), "\"quasi_static\" cannot be cut", "tensor_mass, implicit, hybrid",
                 "quasi_static"},
           Wrong{"[[tool]]", power.c_str(), "power", "(W)"},
           Wrong{"[[tool]]", energy.c_str(), "energy", "(J/m^3)"},
           Wrong{"[[tool]]", spot.c_str(), "spot", "(m)"},
           Wrong{"[[tool]]", piece.c_str(), "smallest_piece", "between 0 and 1 (m^3)"},
           Wrong{"[[tool]]", wrong_key.c_str(), "watts", "power"},
           Wrong{"[[tool]]", normal.c_str(), "normal", "a length above 0"},
           Wrong{"[[tool]]", within.c_str(), "within", "(m)"},
           Wrong{"[[tool]]", tough.c_str(), "toughness", "(J/m^2)"},
           Wrong{"[[tool]]", "cut_buttons = 1\nblade = [0, 0, 0]", "blade", "0.1 mm away at least"},
           Wrong{"[[tool]]", "blade = [0, -0.01, 0]", "blade", "give this [[tool]] `cut_buttons`"},
           Wrong{"[[tool]]", growth.c_str(), "growth", "unknown key"},
       })
    check_refused(wrong);
}

TEST_CASE("[cutting]: a region without any tetrahedron, elements and supports that cannot be cut") {
  const SceneWith nothing("[[tool]]", "cut_buttons = 1\n[cutting]\ncenter = [9, 9, 9]\nradius = 0.1");
  CHECK(nothing.error(true).find("no tetrahedron of the mesh lies in what can be cut") != std::string::npos);
  const std::string cutter = "\n[[tool]]\nradius = 0.01\ncut_buttons = 1\n[cutting]";
  const SceneWith quadratic("[material]", "element = \"p2\"" + cutter);
  CHECK(quadratic.error().find("tissue of element \"p2\" cannot be cut") != std::string::npos);
  const SceneWith loaded("[[tool]]", "cut_buttons = 1\n[cutting]\n[[load]]\ngravity = [0, -9.81, 0]");
  CHECK(loaded.error().find("cannot bear loads besides tools yet") != std::string::npos);
  const std::string motion = "[[fixed.motion]]\ndirection = [0, 1, 0]\namplitude = 0.001\nperiod = 1";
  CHECK(SceneWith("[[fixed]]", motion + cutter).error().find("cannot move with its supports yet") !=
        std::string::npos);
}

TEST_CASE("[material]: values out of range, and names that are none") {
  constexpr const char* kFraction = "[[material.relaxation]]\ntime = 1\nfraction = ";
  const std::string none = std::string(kFraction) + "0", all = std::string(kFraction) + "1",
                    too_many = std::string(kFraction) + "0.6\n" + kFraction + "0.4";
  for (const Wrong& wrong : {
           Wrong{"[material]", "young_modulus = 0", "young_modulus", "between 0.001"},
           Wrong{"[material]", "poisson_ratio = 0.5", "poisson_ratio", "between 0 and 0.499999"},
           Wrong{"[material]", "poisson_ratio = -0.1", "poisson_ratio", "between 0 and 0.499999"},
           Wrong{"[material]", "density = 0", "density", "between 0.001 and 100000 (kg/m3)"},
           Wrong{"[material]", "law = \"hooke\"", "law", "linear, corotational, neo_hookean, stvk"},
           Wrong{"[material]", "element = \"hexahedron\"", "element", "p1, p1_nodal_pressure, p2"},
           Wrong{"[material]", "[material.fibres]\nmodulus = 1\ndirection = [0, 0, 0]", "direction",
                 "a length above 0"},
           Wrong{"[material]", "[material.fibres]\ndirection = [1, 0, 0]\nmodulus = 0", "modulus",
                 "between 0.001"},
           Wrong{"[material]", none.c_str(), "fraction", "between 1e-06 and 0.999999"},
           Wrong{"[material]", all.c_str(), "fraction", "between 1e-06 and 0.999999"},
           Wrong{"[material]", too_many.c_str(), "fractions", "are 1 together; less than 1"},
           Wrong{"[material]", "[[material.inclusion]]\ncenter = [0, 0, 0]\nradius = 1\nyoung_modulus = 0",
                 "young_modulus", "between 0.001"},
           Wrong{"[material]", "inclusion = [{young_modulus = 1}]", "[[material.inclusion]]", "one of `box`"},
           Wrong{"[material]", "inclusion = [{young_modulus = 1, surface_tag = \"top\"}]", "surface_tag",
                 "a `box`, or `center` with `radius`"},
           Wrong{"[material]",
                 "element = \"p1_nodal_pressure\"\n"
                 "inclusion = [{young_modulus = 1, center = [0, 0, 0], radius = 1}]",
                 "[[material.inclusion]]", "take \"p1\" or \"p2\""},
           Wrong{"[material]", "[[material.relaxation]]\nfraction = 0.5\ntime = 0", "time",
                 "between 0.0001 and 1000000 (s)"},
       })
    check_refused(wrong);
}

TEST_CASE("other sections: values out of range") {
  for (const Wrong& wrong : {
           Wrong{"", "rate_hz = -1", "rate_hz", "between 0 and 10000 (Hz)"},
           Wrong{"", "rate_hz = 0.5", "rate_hz", "0 or from 1 to 10000 Hz"},
           Wrong{"", "rate_hz = 10001", "rate_hz", "between 0 and 10000 (Hz)"},
           Wrong{"[[fixed]]", "axes = \"\"", "axes", "some of x, y, z"},
           Wrong{"[[fixed]]", "axes = \"xw\"", "axes", "some of x, y, z"},
           Wrong{"[[fixed]]", "[[fixed.motion]]\namplitude = 0.1\nperiod = 1\ndirection = [0, 0, 0]",
                 "direction", "a length above 0"},
           Wrong{"[[fixed]]", "[[fixed.motion]]\ndirection = [1, 0, 0]\nperiod = 1\namplitude = 1.1",
                 "amplitude", "between 0 and 1 (m)"},
           Wrong{"[[fixed]]", "[[fixed.motion]]\ndirection = [1, 0, 0]\namplitude = 1\nperiod = 0", "period",
                 "between 0.01 and 10000 (s)"},
           Wrong{"[[fixed]]", "[[load]]\ngravity = [0, 1e5, 0]", "gravity", "between -10000 and 10000"},
           Wrong{"[[fixed]]", "[[load]]\nsurface_tag = \"top\"\npressure = inf", "pressure", "between"},
           Wrong{"[[fixed]]", "[[load]]\nforce = [0, 1, 0]\ncenter = [0, 0, 0]\nradius = 0", "radius",
                 "between 1e-09 and 1000 (m)"},
           Wrong{"[[tool]]", "radius = 0", "radius", "between 1e-05 and 0.05 (m)"},
           Wrong{"[[tool]]", "friction = -0.1", "friction", "between 0 and 10"},
           Wrong{"[[tool]]", "grasp_buttons = 65536", "grasp_buttons", "between 1 and 65535"},
       })
    check_refused(wrong);
}

TEST_CASE("[deformation]: a key of other models says whose it is") {
  for (const Wrong& wrong : {
           Wrong{"[deformation]", "max_newton = 5", "unknown key `[deformation] max_newton`",
                 "of model \"quasi_static\"; known to: implicit", "quasi_static"},
           Wrong{"[deformation]", "tolerance = 1e-4", "`[deformation] tolerance`", "known to: implicit",
                 "tensor_mass"},
           Wrong{"[deformation]", "solver = \"direct\"", "`[deformation] solver`", "known to: implicit",
                 "rigid"},
           Wrong{"[deformation]", "integrator = \"bdf2\"", "`[deformation] integrator`", "known to: implicit",
                 "spring"},
           Wrong{"[deformation]", "refresh_steps = 4", "`[deformation] refresh_steps`", "known to: implicit",
                 "quasi_static"},
           Wrong{"[deformation]", "refresh_steps = 4", "factors where it has to", "for quasi_newton"},
           Wrong{"[deformation]", "rayleigh_mass = 1", "`[deformation] rayleigh_mass`",
                 "known to: tensor_mass, implicit", "quasi_static"},
           Wrong{"[deformation]", "modes = 20", "`[deformation] modes`", "known to: ", "implicit"},
           Wrong{"[deformation]", "stiffness = 800", "`[deformation] stiffness`", "known to: rigid",
                 "quasi_static"},
           Wrong{"[deformation]", "spring_stiffness = [1, 1, 1]", "`[deformation] spring_stiffness`",
                 "known to: spring", "implicit"},
           Wrong{"[deformation]", "hardening_length = 1", "`[deformation] hardening_length`",
                 "known to: spring", "rigid"},
       })
    check_refused(wrong);
  // A slip of the pen is not taken for a key of another model.
  CHECK(SceneWith("[deformation]", "max_newtn = 5", "quasi_static").error().find("did you mean") ==
        std::string::npos);
  CHECK(SceneWith("[deformation]", "max_newtn = 5").error().find("did you mean \"max_newton\"") !=
        std::string::npos);
}

TEST_CASE("a model that does not deform refuses a material that asks for it, and says who would not") {
  for (const char* model : {"rigid", "spring"}) {
    for (const auto& [material, models] : std::initializer_list<std::pair<const char*, const char*>>{
             {"law = \"corotational\"", ": implicit"},
             {"[[material.relaxation]]\nfraction = 0.5\ntime = 1", ": implicit"},
             {"[material.fibres]\ndirection = [1, 0, 0]\nmodulus = 1e4", ": quasi_static, implicit"},
             {"inclusion = [{young_modulus = 1, center = [0, 0, 0], radius = 1}]", ": quasi_static, "},
             {"element = \"p2\"", ": quasi_static, implicit"}}) {
      const std::string said = SceneWith("[material]", material, model).error();
      CAPTURE(said);
      CHECK(said.starts_with(fmt::format(":6: model \"{}\" does not deform", model)));
      CHECK(said.find(std::string("for this material") + models) != std::string::npos);
    }
  }
}

TEST_CASE("rate 0 is refused by models that must know the time of a step, and taken by the others") {
  for (const DeformationModelRow& row : models_without_cutting()) {
    const std::string said = SceneWith("", "rate_hz = 0", std::string(row.name)).error(true);
    CAPTURE(row.name, said);
    if (!row.takes<RayleighDamping>()) CHECK(said.empty());
    if (row.takes<RayleighDamping>())
      CHECK(said.starts_with(":1: `rate_hz` = 0, but model \"" + std::string(row.name)));
    if (row.takes<RayleighDamping>()) CHECK(said.find("name a rate, such as 30") != std::string::npos);
  }
}
