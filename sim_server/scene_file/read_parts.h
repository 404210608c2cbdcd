#pragma once
/// Sections of a scene file that have much in them.
#include <vector>

#include "common/config.h"
#include "sim_server/scene/scene.h"

namespace palpate::sim {

/// `box`, `surface_tag`, or `center` and `radius`, of which a section has one; `section` is its name for
/// messages. Leaves other keys to the caller. These all throw `Error`.
Region read_region(const Config& config, const std::string& section);

/// `axes`: "x", "xz", ..; absent: all.
HeldAxes read_axes(const Config& config);

/// `[[load]]`.
Load read_load(const Config& config);

/// `[material]`.
Material read_material(const Config& config);

/// Returns the name in `law` and `element` of `[material]`.
std::string_view name_of(ElasticLaw law);
std::string_view name_of(ElementKind element);
/// Returns all allowed values of these keys, in their order in messages.
std::vector<ElasticLaw> elastic_laws();
std::vector<ElementKind> element_kinds();

}  // namespace palpate::sim
