#include <algorithm>

#include "common/parallel.h"
#include "sim_server/elasticity/laws.h"
#include "sim_server/elasticity/rotations.h"
#include "sim_server/elasticity/solid.h"
#include "sim_server/elasticity/solid_element.h"
#include "sim_server/elasticity/turned_back.h"

namespace palpate::sim {
namespace {

constexpr std::size_t kTask = 64;      // elements of one task
constexpr std::size_t kTogether = 16;  // elements whose rotations are looked for together

/// Calls `work` with the class of the law.
template <class Work>
void with_law(ElasticLaw law, const Work& work) {
  switch (law) {
    case ElasticLaw::kLinear:
      return work.template operator()<LinearLaw>();
    case ElasticLaw::kCorotational:
      return work.template operator()<CorotationalLaw>();
    case ElasticLaw::kStVenantKirchhoff:
      return work.template operator()<StVenantKirchhoffLaw>();
    case ElasticLaw::kNeoHookean:
      return work.template operator()<NeoHookeanLaw>();
  }
}

}  // namespace

/// `work(element, F, R)` for the tetrahedra from `begin` to `end`, in order: deformation gradient at each of
/// its points and, where the law asks for it, the rotation nearest to it.
template <class Law, class Work>
void Solid::each_element(std::span<const Vec3> x, std::size_t begin, std::size_t end,
                         const Work& work) const {
  std::array<Mat3, kTogether * kMostPoints> F, R;
  const auto points = static_cast<std::size_t>(points_);
  for (std::size_t from = begin; from < end; from += kTogether) {
    const std::size_t count = std::min(kTogether, end - from);
    for (std::size_t k = 0; k < count; ++k) Element(*this, from + k).deform(x, F.data() + k * points);
    if constexpr (Law::kTurns) nearest_rotations({F.data(), count * points}, R);
    for (std::size_t k = 0; k < count; ++k)
      work(Element(*this, from + k), F.data() + k * points, R.data() + k * points);
  }
}

/// Averages the dilation of each tetrahedron, then of each vertex.
void Solid::average_dilation(std::span<const Vec3> x, Scratch& scratch) const {
  with_law(material_.law, [&]<class Law>() {
    const Moduli moduli = Law::moduli(material_);
    parallel_blocks(elements(), kTask, [&](std::size_t begin, std::size_t end) {
      each_element<Law>(x, begin, end, [&](const Element& element, const Mat3* F, const Mat3* R) {
        scratch.dilation_[element.point(0)] = law_at<Law>(moduli, *F, *R).dilation();
      });
    });
  });
  for (std::size_t a = 0; a < rest_.size(); ++a) {
    double sum = 0;
    for (int k = around_first_[a]; k < around_first_[a + 1]; ++k)
      sum += weight_[around_[k]] / 4 * scratch.dilation_[around_[k]];
    scratch.nodal_dilation_[a] = nodal_volume_[a] > 0 ? sum / nodal_volume_[a] : 0;
  }
}

void Solid::evaluate(std::span<const Vec3> positions, std::span<State> at_points, const Viscosity& viscosity,
                     Scratch& scratch) const {
  const TurnedBack turned(*this, positions);
  const std::span<const Vec3> x = turned.x();
  if (averages()) average_dilation(x, scratch);
  with_law(material_.law, [&]<class Law>() {
    const Moduli moduli = Law::moduli(material_);
    parallel_blocks(elements(), kTask, [&](std::size_t begin, std::size_t end) {
      each_element<Law>(x, begin, end, [&](const Element& element, const Mat3* F, const Mat3* R) {
        for (int q = 0; q < points_; ++q) {
          State& state = at_points[element.point(q)];
          state.F = F[q];
          const Law law = law_at<Law>(moduli, F[q], R[q]);
          const double theta = averages() ? scratch.mean_dilation(element.nodes) : law.dilation();
          state.stress = law.shape_stress() + moduli.lambda * theta * law.dilation_gradient();
          state.energy = law.shape_energy() + (averages() ? 0 : 0.5 * moduli.lambda * theta * theta);
          if (material_.fibres) {
            const FibreLaw fibres = fibre_law(state.F);
            state.stress += fibres.stress();
            state.energy += fibres.energy();
          }
          state.stress *= viscosity.scale;
          if (!viscosity.memory.empty())
            state.stress += element.stored(state.F, viscosity.memory[element.point(q)]);
        }
        for (int i = 0; averages() && i < 4; ++i) {
          const double theta = scratch.nodal_dilation_[element.nodes[i]];
          at_points[element.point(0)].energy += 0.125 * moduli.lambda * theta * theta;
        }
      });
    });
  });
}

void Solid::node_rotations(std::span<const Vec3> x, std::span<Mat3> rotations) const {
  if (material_.law == ElasticLaw::kLinear) {
    const TurnedBack turned(*this, x);
    for (int i = 0; i < nodes(); ++i) {
      const Mat3* const R = turned.rotation(i);
      rotations[static_cast<std::size_t>(i)] = R != nullptr ? *R : Mat3(Mat3::Identity());
    }
    return;
  }
  std::vector<Mat3> sums(rest_.size(), Mat3::Zero());
  each_element<LinearLaw>(x, 0, elements(), [&](const Element& element, const Mat3* F, const Mat3*) {
    for (int q = 0; q < points_; ++q) {
      for (int i = 0; i < corners_; ++i) sums[element.nodes[i]] += element.weight(q) * F[q];
    }
  });
  for (Mat3& sum : sums) {
    const double size = sum.norm();
    sum = size > 0 ? Mat3(sum / size) : Mat3(Mat3::Identity());  // of a node that has no tetrahedron left
  }
  parallel_blocks(sums.size(), kTask, [&](std::size_t begin, std::size_t end) {
    nearest_rotations(std::span(sums).subspan(begin, end - begin), rotations.subspan(begin, end - begin));
  });
}

FibreLaw Solid::fibre_law(const Mat3& F) const {
  return {material_.fibres->modulus, material_.fibres->direction, F, material_.law == ElasticLaw::kLinear};
}

double Solid::energy_of(std::size_t e, std::span<const Vec3> positions) const {
  const TurnedBack turned(*this, positions);
  const std::span<const Vec3> x = turned.x();
  double energy = 0;
  with_law(material_.law, [&]<class Law>() {
    const Moduli moduli = Law::moduli(material_);
    each_element<Law>(x, e, e + 1, [&](const Element& element, const Mat3* F, const Mat3* R) {
      for (int q = 0; q < points_; ++q) {
        const Law law = law_at<Law>(moduli, F[q], R[q]);
        double density = law.shape_energy() + 0.5 * moduli.lambda * law.dilation() * law.dilation();
        if (material_.fibres) density += fibre_law(F[q]).energy();
        energy += element.weight(q) * density;
      }
    });
  });
  return energy;
}

double Solid::energy(std::span<const Vec3> x, Scratch& scratch) const {
  std::vector<State> states(points());
  evaluate(x, states, {}, scratch);
  double sum = 0;
  for (std::size_t p = 0; p < points(); ++p) sum += weight_[p] * states[p].energy;
  return sum;
}

void Solid::forces(std::span<const Vec3> x, std::span<Vec3> f, const Viscosity& viscosity,
                   Scratch& scratch) const {
  const TurnedBack turned(*this, x);
  sum_forces(turned.x(), f, viscosity, scratch);
  turned.turn_forces(f);
}

/// Sums the forces of all elements, whatever has turned.
void Solid::sum_forces(std::span<const Vec3> x, std::span<Vec3> f, const Viscosity& viscosity,
                       Scratch& scratch) const {
  if (averages()) average_dilation(x, scratch);
  std::ranges::fill(f, Vec3::Zero());
  const auto corners = static_cast<std::size_t>(corners_);
  for (std::size_t from = 0; from < elements(); from += kElementsOfBatch) {
    const std::size_t count = std::min(kElementsOfBatch, elements() - from);
    with_law(material_.law, [&]<class Law>() {
      parallel_blocks(count, kTask, [&](std::size_t begin, std::size_t end) {
        Vec3* own = scratch.forces_.data() + begin * corners;
        each_element<Law>(x, from + begin, from + end,
                          [&](const Element& element, const Mat3* F, const Mat3* R) {
                            element_forces<Law>(element, F, R, own, viscosity, scratch);
                            own += corners;
                          });
      });
    });
    for (std::size_t k = 0; k < count * corners; ++k)
      f[element_nodes_[from * corners + k]] += scratch.forces_[k];
  }
}

template <class Law>
void Solid::element_forces(const Element& element, const Mat3* F, const Mat3* R, Vec3* f,
                           const Viscosity& viscosity, const Scratch& scratch) const {
  const Moduli moduli = Law::moduli(material_);
  std::fill_n(f, corners_, Vec3::Zero());
  for (int q = 0; q < points_; ++q) {
    const Law law = law_at<Law>(moduli, F[q], R[q]);
    const double theta = averages() ? scratch.mean_dilation(element.nodes) : law.dilation();
    Mat3 stress = law.shape_stress() + moduli.lambda * theta * law.dilation_gradient();
    if (material_.fibres) stress += fibre_law(F[q]).stress();
    stress *= viscosity.scale;
    if (!viscosity.memory.empty()) stress += element.stored(F[q], viscosity.memory[element.point(q)]);
    const Vec3* const g = element.gradients(q);
    for (int i = 0; i < corners_; ++i) f[i] += element.weight(q) * (stress * g[i]);
  }
}

void Solid::add_stiffness(std::span<const Vec3> x, StiffnessMatrix& k, const Viscosity& viscosity,
                          Scratch& scratch) const {
  if (averages()) average_dilation(x, scratch);
  const TurnedBack turned(*this, x);
  const std::size_t blocks = blocks_of(corners_), corners = static_cast<std::size_t>(corners_);
  for (std::size_t from = 0; from < elements(); from += kElementsOfBatch) {
    const std::size_t count = std::min(kElementsOfBatch, elements() - from);
    with_law(material_.law, [&]<class Law>() {
      parallel_blocks(count, kTask, [&](std::size_t begin, std::size_t end) {
        Mat3* own = scratch.blocks_.data() + begin * blocks;
        each_element<Law>(x, from + begin, from + end,
                          [&](const Element& element, const Mat3* F, const Mat3* R) {
                            element_stiffness<Law>(element, F, R, own, viscosity, scratch);
                            turned.turn_blocks(element.nodes[0], {own, blocks});
                            own += blocks;
                          });
      });
    });
    // Each group of blocks in the order of the elements, so that the sums are the same on any number of
    // cores.
    parallel_blocks(StiffnessMatrix::kGroups, 1, [&](std::size_t group, std::size_t) {
      for (std::size_t e = 0; e < count; ++e) {
        const Mat3* block = scratch.blocks_.data() + e * blocks;
        const int* const nodes = element_nodes_.data() + (from + e) * corners;
        for (int i = 0; i < corners_; ++i) {
          for (int j = 0; j <= i; ++j, ++block) {
            if (k.is_of_group(group, nodes[i], nodes[j])) k.add(nodes[i], nodes[j], *block);
          }
        }
      }
    });
  }
  if (averages()) add_nodal_stiffness(x, k, viscosity.scale);
}

void Solid::stiffness_of(std::size_t e, std::span<const Vec3> x, const Viscosity& viscosity, Scratch& scratch,
                         const TakeBlock& take) const {
  const TurnedBack turned(*this, x);
  std::array<Mat3, kMostCorners*(kMostCorners + 1) / 2> blocks;
  with_law(material_.law, [&]<class Law>() {
    each_element<Law>(x, e, e + 1, [&](const Element& element, const Mat3* F, const Mat3* R) {
      element_stiffness<Law>(element, F, R, blocks.data(), viscosity, scratch);
      turned.turn_blocks(element.nodes[0], std::span(blocks).first(blocks_of(corners_)));
      const Mat3* block = blocks.data();
      for (int i = 0; i < corners_; ++i) {
        for (int j = 0; j <= i; ++j) take(element.nodes[i], element.nodes[j], *block++);
      }
    });
  });
}

template <class Law>
void Solid::element_stiffness(const Element& element, const Mat3* F, const Mat3* R, Mat3* k,
                              const Viscosity& viscosity, const Scratch& scratch) const {
  const Moduli moduli = Law::moduli(material_);
  std::fill_n(k, blocks_of(corners_), Mat3::Zero());
  for (int q = 0; q < points_; ++q) {
    Law law = law_at<Law>(moduli, F[q], R[q]);
    law.prepare_blocks();
    const double theta = averages() ? scratch.mean_dilation(element.nodes) : law.dilation();
    const double weight = viscosity.scale * element.weight(q);
    const Mat3 dilation = law.dilation_gradient();
    const Vec3* const g = element.gradients(q);
    std::array<Vec3, kMostCorners> along;  // how the dilation goes with each node
    for (int i = 0; i < corners_; ++i) along[i] = dilation * g[i];
    Mat3* block = k;
    for (int i = 0; i < corners_; ++i) {
      for (int j = 0; j <= i; ++j, ++block) {
        *block += weight * law.block(moduli.lambda * theta, g[i], g[j]);
        if (!averages()) *block += weight * moduli.lambda * along[i] * along[j].transpose();
      }
    }
    if (material_.fibres || !viscosity.memory.empty()) add_extras(element, q, F[q], viscosity, k);
  }
}

/// Adds the stress of fibres, and that which is remembered, which turns with the tissue.
void Solid::add_extras(const Element& element, int q, const Mat3& F, const Viscosity& viscosity,
                       Mat3* k) const {
  const Vec3* const g = element.gradients(q);
  for (int i = 0; i < corners_; ++i) {
    for (int j = 0; j <= i; ++j, ++k) {
      if (material_.fibres) *k += viscosity.scale * element.weight(q) * fibre_law(F).block(g[i], g[j]);
      if (viscosity.memory.empty() || material_.law == ElasticLaw::kLinear) continue;
      k->diagonal().array() += element.weight(q) * g[i].dot(viscosity.memory[element.point(q)] * g[j]);
    }
  }
}

/// Adds the stiffness of the averaged dilation: V_a lambda (dtheta_a/dx) (dtheta_a/dx)^T for each vertex a,
/// which ties all nodes of the tetrahedra around it.
void Solid::add_nodal_stiffness(std::span<const Vec3> x, StiffnessMatrix& k, double scale) const {
  std::vector<Vec3> along(4 * elements());  // V_e dtheta_e by node
  double lambda = 0;
  with_law(material_.law, [&]<class Law>() {
    const Moduli moduli = Law::moduli(material_);
    lambda = moduli.lambda;
    parallel_blocks(elements(), kTask, [&](std::size_t begin, std::size_t end) {
      each_element<Law>(x, begin, end, [&](const Element& element, const Mat3* F, const Mat3* R) {
        const Mat3 dilation = law_at<Law>(moduli, *F, *R).dilation_gradient();
        for (std::size_t i = 0; i < 4; ++i)
          along[4 * element.point(0) + i] = element.weight(0) * dilation * element.gradients(0)[i];
      });
    });
  });
  std::vector<std::pair<int, Vec3>> terms;
  for (std::size_t a = 0; a < rest_.size(); ++a) {
    if (!(nodal_volume_[a] > 0)) continue;
    collect_terms(a, along, terms);
    const double factor = scale * lambda / (16 * nodal_volume_[a]);
    for (std::size_t i = 0; i < terms.size(); ++i) {
      for (std::size_t j = 0; j <= i; ++j)
        k.add(terms[i].first, terms[j].first, factor * terms[i].second * terms[j].second.transpose());
    }
  }
}

/// The sum of `along` over the tetrahedra around vertex `a`, by node.
void Solid::collect_terms(std::size_t a, std::span<const Vec3> along,
                          std::vector<std::pair<int, Vec3>>& terms) const {
  terms.clear();
  for (int k = around_first_[a]; k < around_first_[a + 1]; ++k) {
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t at = 4 * static_cast<std::size_t>(around_[k]) + i;
      const int node = element_nodes_[at];
      const auto same = [node](const auto& term) { return term.first == node; };
      const auto found = std::ranges::find_if(terms, same);
      if (found == terms.end()) {
        terms.emplace_back(node, along[at]);
      } else {
        found->second += along[at];
      }
    }
  }
}

}  // namespace palpate::sim
