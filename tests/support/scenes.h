#pragma once
#include "sim_server/models/spring.h"
#include "sim_server/scene/scene.h"
#include "sim_server/scene_file/read_scene.h"
#include "tests/support/paths.h"

namespace palpate::test {

/// A scene that ships, with paths that work from anywhere.
inline sim::Scene example_scene(const std::string& name) {
  return sim::read_scene(source_dir() + "/configs/scenes/" + name + ".toml");
}

inline sim::Scene liver_scene() {
  return example_scene("liver_paper");
}

/// A scene around a mesh made in memory: quasi-static unless said otherwise, fixed where `fixed` contains a
/// vertex.
inline sim::Scene scene_of(const sim::Material& material, const sim::Box& fixed, double tool_radius) {
  sim::Scene scene;
  scene.source = "test";
  scene.material = material;
  scene.deformation.model = "quasi_static";
  scene.deformation.of<sim::SpringSettings>().stiffness = Vec3(40, 50, 60);  // of no effect on other models
  scene.fixed.push_back({{fixed, "", "test"}});
  scene.tools[0].shape.radius = tool_radius;
  return scene;
}

}  // namespace palpate::test
