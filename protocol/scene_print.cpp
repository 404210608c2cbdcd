#include "protocol/scene_print.h"

namespace palpate::protocol {

Endpoint virtual_address(std::uint8_t last, std::uint16_t port) noexcept {
  return {.address = {192, 0, 2, last}, .port = port};
}

Endpoint virtual_server() noexcept {
  return virtual_address(2, 45130);
}

Nonce nonce_of(const ScenePrint& print) noexcept {
  return {std::uint64_t{print.mesh} << 32 | print.material,
          std::uint64_t{print.supports} << 32 | print.tools};
}

std::optional<ScenePrint> print_in(const Welcome& welcome, const Endpoint& from) noexcept {
  if (from != virtual_server() || welcome.server == Nonce{}) return {};
  const auto high = [](std::uint64_t word) { return static_cast<std::uint32_t>(word >> 32); };
  const auto low = [](std::uint64_t word) { return static_cast<std::uint32_t>(word); };
  return ScenePrint{.mesh = high(welcome.server[0]),
                    .material = low(welcome.server[0]),
                    .supports = high(welcome.server[1]),
                    .tools = low(welcome.server[1])};
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
