#pragma once
#include <cmath>

#include "protocol/surface_pages.h"

namespace palpate::client {

/// A page of a surface model (`pages`: of the entire model) with the compliance multiplied by `factor`: it
/// shows how a law performs on a wrong model. Places and mass stay as they are, so that modes are slower by
/// the square root of the factor.
inline protocol::SurfacePage with_scaled_compliance(protocol::SurfacePage page,
                                                    const protocol::SurfacePages& pages,
                                                    double factor) noexcept {
  if (page.page < pages.first_tile()) return page;
  if (page.page < pages.spectrum()) {
    for (float& value : page.values) value *= static_cast<float>(factor);
  } else if (page.page == pages.spectrum()) {
    for (std::size_t k = 0; k < page.values.size(); k += 3)
      page.values[k] /= static_cast<float>(std::sqrt(factor));
  }
  return page;
}

}  // namespace palpate::client
