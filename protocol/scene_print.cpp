#include "protocol/scene_print.h"

namespace palpate::protocol {

std::optional<ScenePrint> print_in(const Welcome& welcome) noexcept {
  if (welcome.scene == ScenePrint{}) return {};
  return welcome.scene;
}

std::string differences(const ScenePrint& a, const ScenePrint& b) {
  std::string text;
  const auto add = [&text](bool differs, const char* name) {
    if (differs) text += (text.empty() ? "" : ", ") + std::string(name);
  };
  add(a.mesh != b.mesh, "mesh");
  add(a.material != b.material, "material");
  add(a.supports != b.supports, "supports or loads");
  add(a.tools != b.tools, "tools or model");
  return text;
}

}  // namespace palpate::protocol
