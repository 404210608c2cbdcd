// The keys of scenes in configs/README.md are those that the readers know.
#include "sim_server/models/deformation_models.h"
#include "sim_server/scene_file/read_scene.h"
#include "tests/support/catch.h"
#include "tests/support/documented_keys.h"

using namespace palpate;
using namespace palpate::sim;
using test::Sections;

namespace {

using Lines = std::vector<std::string>;

/// `all` and `more`.
Lines with(Lines all, const Lines& more) {
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

/// A scene of a model, a shape of tool, a load, and a region for all that has one; with every section but
/// those of a tool's reach.
Sections scene_of(const std::string& model, const Lines& tool, const Lines& load, const Lines& region) {
  Lines deformation{"model = \"" + model + "\""};
  if (model == "spring") deformation.emplace_back("spring_stiffness = [1, 1, 1]");
  if (model == "implicit") deformation.emplace_back("solver = \"quasi_newton\"");
  return {{"", {"rate_hz = 30"}},
          {"[mesh]", {"file = \"organ.msh\""}},
          {"[session]", {"clients = []"}},
          {"[[fixed]]", region},
          {"[[fixed.motion]]", {"direction = [1, 0, 0]", "amplitude = 0.01", "period = 1"}},
          {"[[load]]", with(load, region)},
          {"[material]", {"young_modulus = 1e4", "poisson_ratio = 0.3"}},
          {"[material.fibres]", {"direction = [1, 0, 0]", "modulus = 1e4"}},
          {"[[material.relaxation]]", {"fraction = 0.5", "time = 1"}},
          {"[[material.inclusion]]", with({"young_modulus = 1e5"}, region)},
          {"[deformation]", deformation},
          {"[[tool]]", tool},
          {"[cutting]", region},
          {"[cutting.plan]", {"point = [0, 0, 0]", "normal = [1, 0, 0]"}}};
}

/// A tool within `section`.
Sections scene_with_reach(const std::string& section, const Lines& lines) {
  return {{"", {"rate_hz = 30"}},
          {"[mesh]", {"file = \"organ.msh\""}},
          {"[deformation]", {"model = \"rigid\""}},
          {"[[tool]]", {"shape = \"trocar\"", "pivot = [0, 0, 0]"}},
          {section, lines}};
}

}  // namespace

TEST_CASE("configs/README.md: the keys of a scene are those that its reader knows") {
  const std::set<std::string> documented = test::documented_keys("scene key");
  const Lines pressure{"pressure = 1"}, box{"box = [[-1, -1, -1], [1, 0, 1]]"},
      ball{"center = [0, 0, 0]", "radius = 1"};
  std::vector<Sections> scenes{
      scene_of("rigid", {"shape = \"capsule\"", "length = 0.1"}, {"displacement = [0, 0, 0]"}, box),
      scene_of("rigid", {"shape = \"trocar\"", "pivot = [0, 0, 0]"}, pressure, ball),
      scene_with_reach("[tool.workspace]", {"device = \"falcon\""}),
      scene_with_reach("[tool.cone]", {"axis = [0, 0, 1]", "tilt = 30", "depth = 0.1"})};
  for (const DeformationModelRow& row : deformation_models())
    scenes.push_back(scene_of(std::string(row.name), {"cut_buttons = 1"}, pressure, box));
  const auto names = test::names_in_sources();
  std::set<std::string> known;
  for (const Sections& scene : scenes)
    known.merge(test::known_keys(scene, names, [](const auto& file) { read_scene(file, Purpose::kSolve); }));
  // Every region may be a tag but this one, which is refused with a reason.
  CHECK(known.erase("[[material.inclusion]] surface_tag") == 1);
  CHECK(documented.size() > 80);
  CHECK(test::differences(documented, known) == std::vector<std::string>{});
}
