#include "sim_server/explicit/cuttable_body.h"

#include <algorithm>
#include <iterator>
#include <set>

#include "sim_server/explicit/mass_scaling.h"

namespace palpate::sim {
namespace {

/// Vertices that are fixed or not in motion, ascending.
std::vector<int> standing(const ModelInputs& inputs, const std::vector<char>* moves) {
  std::vector<int> motionless = inputs.fixed;
  for (std::size_t v = 0; moves != nullptr && v < moves->size(); ++v) {
    if ((*moves)[v] == 0) motionless.push_back(static_cast<int>(v));
  }
  std::ranges::sort(motionless);
  motionless.erase(std::unique(motionless.begin(), motionless.end()), motionless.end());
  return motionless;
}

}  // namespace

CuttableBody::CuttableBody(const ModelInputs& inputs, const std::vector<double>& mass_factors,
                           const std::vector<char>* moves, const CondensedPart::Modes& modes)
    : tensors(inputs.mesh, *inputs.scene.material, standing(inputs, moves), mass_factors),
      motion(tensors, inputs.scene.deformation.of<RayleighDamping>()) {
  if (moves != nullptr) {
    rest.emplace(inputs, tensors.places(), modes);
    for (const auto& [number, kg] : rest->border_masses()) tensors.add_mass(number / 3, kg);
  }
  for (const int vertex : inputs.surface.vertices) {
    const int place = tensors.places()[static_cast<std::size_t>(vertex)];
    first.push_back(place < 0 ? -1 : 3 * place);
  }
}

CuttableModel::Removed CuttableBody::remove(std::span<const int> tetrahedra, const CutMesh& remaining,
                                            const Material& material) {
  CuttableModel::Removed removed;
  tensors.remove(tetrahedra, remaining, material);
  const auto remains = [&](int other) { return remaining.remains(other); };
  for (const int t : tetrahedra) {
    for (const int v : remaining.mesh().tetrahedra[static_cast<std::size_t>(t)]) {
      if (rest && rest->part_of(v) >= 0) {
        const CuttableModel::Removed part = rest->remove(rest->part_of(v));
        removed.elastic += part.elastic;
        removed.kinetic += part.kinetic;
      }
      const int place = tensors.places()[static_cast<std::size_t>(v)];
      if (place >= 0 && std::ranges::none_of(remaining.around(v), remains))  // else it would drift for ever
        Eigen::Map<Vec3>(motion.state.v.data() + 3 * place).setZero();
    }
  }
  return removed;
}

void CuttableBody::part(std::span<const CuttableModel::Slide> slides, const Parting& parting,
                        const CutMesh& remaining, const Material& material, double frequency) {
  std::vector<int> slid;
  for (const CuttableModel::Slide& slide : slides) {
    const int place = tensors.places()[static_cast<std::size_t>(slide.vertex)];
    const int other = tensors.places()[static_cast<std::size_t>(slide.towards)];
    for (std::vector<double>* const all : {&motion.state.u, &motion.state.v}) {
      Eigen::Map<Vec3> own(all->data() + 3 * place);
      Vec3 end = Vec3::Zero();  // of what stands
      if (other >= 0) end = Eigen::Map<const Vec3>(all->data() + 3 * other);
      own += slide.fraction * (end - own);
    }
    slid.push_back(slide.vertex);
  }
  reshape(slid, parting, remaining, material, frequency);
}

void CuttableBody::reshape(std::span<const int> slid, const Parting& parting, const CutMesh& remaining,
                           const Material& material, double frequency) {
  std::vector<int> reshaped;
  const auto reshape_around = [&](int vertex) {
    std::ranges::copy_if(remaining.around(vertex), std::back_inserter(reshaped),
                         [&](int t) { return remaining.remains(t); });
  };
  std::ranges::for_each(slid, reshape_around);
  const auto first_of = [&](int vertex) -> int& {
    return first[static_cast<std::size_t>(remaining.number_of(vertex))];
  };
  for (const Split& split : parting.splits) {
    reshape_around(split.copy);
    first_of(split.copy) = static_cast<int>(motion.state.u.size());
    motion.append_copy_of(first_of(split.vertex) / 3);
  }
  for (const int t : reshaped)
    tensors.set_mass_factor(
        t, mass_factor_of(remaining.mesh(), static_cast<std::size_t>(t), material, frequency));
  tensors.part(parting, reshaped, remaining, material);
}

void CuttableBody::release(std::span<const std::vector<int>> floating, const TetMesh& mesh) {
  std::vector<std::vector<FloatingPieces::Node>> pieces;
  std::vector<std::pair<int, int>> condensed;  // parts that float, with a vertex in motion of their piece
  const auto place_of = [this](int v) { return tensors.places()[static_cast<std::size_t>(v)]; };
  for (const std::vector<int>& tetrahedra : floating) {
    std::set<int> vertices, moving, parts;
    for (const int t : tetrahedra) {
      const Tetrahedron& corners = mesh.tetrahedra[static_cast<std::size_t>(t)];
      vertices.insert(corners.begin(), corners.end());
    }
    std::ranges::copy_if(vertices, std::inserter(moving, moving.end()),
                         [&](int v) { return place_of(v) >= 0; });
    for (const int v : vertices) {
      if (!moving.contains(v)) parts.insert(rest ? rest->part_of(v) : -1);
    }
    if (moving.empty() || parts.contains(-1)) continue;  // something holds it
    for (const int part : parts) {
      rest->end_modes(part, tensors, motion.state.v);
      condensed.emplace_back(part, *moving.begin());
    }
    std::vector<FloatingPieces::Node>& piece = pieces.emplace_back();
    for (const int v : moving)
      piece.push_back({place_of(v), tensors.masses()[static_cast<std::size_t>(place_of(v))],
                       mesh.vertices[static_cast<std::size_t>(v)]});
  }
  motion.release({std::move(pieces), tensors.masses().size()});
  for (const auto& [part, vertex] : condensed) {
    const Vec3& from_centre = motion.floating().node(place_of(vertex)).rest;
    rest->release(part, motion.floating(), mesh.vertices[static_cast<std::size_t>(vertex)] - from_centre);
  }
  if (rest) rest->turn(motion.floating(), motion.frames());
}

void CuttableBody::pull_border(bool changed, std::span<double> force) noexcept {
  if (changed) motion.find_frames();
  rest->turn(motion.floating(), motion.frames());
  rest->observe(motion.state.u, motion.state.v);
  std::ranges::fill(force, 0);
  rest->follow(force);
  motion.turn_forces(force);
}

void CuttableBody::place_rest() noexcept {
  rest->turn(motion.floating(), motion.frames());
  rest->place_at(motion.state.u);
}

}  // namespace palpate::sim
