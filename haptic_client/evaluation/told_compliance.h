#pragma once
#include "protocol/surface_pages.h"

namespace palpate::client {

/// A page of a surface model (`pages`: of the whole of it) as a server would send it that takes the tissue
/// for `factor` times as compliant as it is: how a law does on a wrong model. Shape and force stay as they
/// are.
inline protocol::SurfacePage with_compliance(protocol::SurfacePage page, const protocol::SurfacePages& pages,
                                             double factor) noexcept {
  if (page.page < pages.first_tile()) return page;
  for (float& value : page.values) value *= static_cast<float>(factor);
  return page;
}

}  // namespace palpate::client
