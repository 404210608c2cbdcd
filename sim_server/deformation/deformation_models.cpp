#include "sim_server/deformation/deformation_models.h"

#include <array>

#include "sim_server/deformation/implicit.h"
#include "sim_server/deformation/quasi_static.h"
#ifdef PALPATE_WITH_SPECTRA
#include "sim_server/deformation/reduced.h"
#endif
#include "sim_server/deformation/rigid.h"
#include "sim_server/deformation/spring.h"
#include "sim_server/deformation/tensor_mass.h"

namespace palpate::sim {
namespace {

template <class Model>
std::unique_ptr<DeformationModel> make(const ModelInputs& inputs) {
  return std::make_unique<Model>(inputs);
}

constexpr std::array kModels{
    DeformationModelRow{.name = "rigid",
                        .summary = "no deformation; force = stiffness x penetration depth",
                        .make = &make<Rigid>,
                        .penalty = true},
    DeformationModelRow{.name = "quasi_static",
                        .summary = "linear elastic equilibrium by pre-computed compliance",
                        .make = &make<QuasiStatic>,
                        .elastic = true,
                        .follows_supports = true,
                        .any_linear = true},
    DeformationModelRow{.name = "tensor_mass",
                        .summary = "linear elastic motion, explicit, by a tensor per vertex and edge",
                        .make = &make<TensorMass>,
                        .elastic = true,
                        .follows_supports = true,
                        .damped = true},
    DeformationModelRow{.name = "implicit",
                        .summary = "motion of any law, element and load, by implicit steps",
                        .make = &make<Implicit>,
                        .follows_supports = true,
                        .any_material = true,
                        .damped = true},
#ifdef PALPATE_WITH_SPECTRA
    DeformationModelRow{.name = "reduced",
                        .summary = "linear elastic: the slowest modes swing, the rest follows at once",
                        .make = &make<Reduced>,
                        .elastic = true,
                        .follows_supports = true,
                        .any_linear = true,
                        .damped = true,
                        .modal = true},
#endif
    DeformationModelRow{.name = "spring",
                        .summary = "no deformation; the organ hangs on a spring that hardens",
                        .make = &make<Spring>,
                        .hangs = true},
};

}  // namespace

std::span<const DeformationModelRow> deformation_models() {
  return kModels;
}

}  // namespace palpate::sim
