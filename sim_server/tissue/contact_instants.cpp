#include "sim_server/tissue/contact_instants.h"

#include <fmt/core.h>

namespace palpate::sim {

ContactInstants ContactInstants::read(const Config& config) {
  ContactInstants read;
  if (config.says("instants"))
    read.instants = static_cast<int>(config.integer("instants", {1, 1000, "instants"}));
  return read;
}

std::string ContactInstants::to_text() const {
  return instants ? fmt::format("instants = {}\n", *instants) : "";
}

int instants_of(const DeformationSettings& settings, int otherwise) {
  const auto* const found = settings.find<ContactInstants>();
  return found == nullptr ? 1 : found->instants.value_or(otherwise);
}

}  // namespace palpate::sim
