#include "sim_server/scene_file/read_inclusions.h"

#include "common/error.h"
#include "sim_server/scene_file/read_parts.h"

namespace palpate::sim {

std::vector<Inclusion> read_inclusions(const Config& material) {
  std::vector<Inclusion> inclusions;
  for (const Config& section : material.tables("inclusion")) {
    Inclusion inclusion{read_region(section, "[[material.inclusion]]")};
    if (!inclusion.surface_tag.empty())
      fail("{}: `surface_tag`: an inclusion is a `box`, or `center` with `radius`", inclusion.where);
    inclusion.young_modulus = section.number("young_modulus", {1e-3, 1e12, "Pa"});
    section.reject_unknown();
    inclusions.push_back(std::move(inclusion));
  }
  return inclusions;
}

}  // namespace palpate::sim
