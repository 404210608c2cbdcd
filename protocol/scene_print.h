#pragma once
#include <optional>
#include <string>

#include "protocol/messages.h"

namespace palpate::protocol {

/// Returns the print in a Welcome; nothing where its server does not know the scene.
std::optional<ScenePrint> print_in(const Welcome& welcome) noexcept;

/// Returns in words what differs, as "mesh, material"; empty: nothing does.
std::string differences(const ScenePrint& a, const ScenePrint& b);

}  // namespace palpate::protocol
