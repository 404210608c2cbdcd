#include "sim_server/deformation/deformation_models.h"

#include <array>

#include "sim_server/deformation/quasi_static.h"
#include "sim_server/deformation/rigid.h"
#include "sim_server/deformation/spring.h"

namespace palpate::sim {
namespace {

template <class Model>
std::unique_ptr<DeformationModel> make(const ModelInputs& inputs) {
  return std::make_unique<Model>(inputs);
}

constexpr std::array kModels{
    DeformationModelRow{"rigid", "no deformation; force = stiffness x penetration depth", &make<Rigid>},
    DeformationModelRow{"quasi_static", "linear elastic equilibrium by pre-computed compliance",
                        &make<QuasiStatic>, true},
    DeformationModelRow{"spring", "no deformation; the organ hangs on a spring that hardens", &make<Spring>},
};

}  // namespace

std::span<const DeformationModelRow> deformation_models() {
  return kModels;
}

}  // namespace palpate::sim
