// How a rest is condensed: the set-up of CondensedPart.
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <map>

#include "common/error.h"
#include "common/memory_budget.h"
#include "sim_server/elasticity/element.h"
#include "sim_server/elasticity/tensors.h"
#include "sim_server/explicit/condensed_part.h"
#include "sim_server/mesh/disjoint_sets.h"
#include "sim_server/mesh/loose_parts.h"
#include "sim_server/statics/linear_statics.h"

namespace palpate::sim {
namespace {

constexpr int kUnknownsPerMode = 8;  // at least

using Triplets = std::vector<Eigen::Triplet<double>>;

void sort_unique(std::vector<int>& numbers) {
  std::ranges::sort(numbers);
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

/// Returns where a number is in an ascending list that has it.
int place_in(const std::vector<int>& list, int number) {
  return static_cast<int>(std::ranges::lower_bound(list, number) - list.begin());
}

/// A <- A - X^T X, of a symmetric A: its lower triangle, mirrored, so that it is symmetric to the last bit.
void subtract_gram(const Eigen::MatrixXd& x, Eigen::MatrixXd& a) {
  if (x.size() == 0) return;  // no modes, or no surface
  a.selfadjointView<Eigen::Lower>().rankUpdate(x.transpose(), -1.0);
  a.triangularView<Eigen::StrictlyUpper>() = a.transpose();
}

/// Returns what is held while the motion stands still: what is fixed, and all that moves; ascending.
std::vector<int> held_by(const std::vector<int>& fixed, const std::vector<int>& places) {
  std::vector<int> held = fixed;
  for (int v = 0; v < static_cast<int>(places.size()); ++v) {
    if (places[static_cast<std::size_t>(v)] >= 0) held.push_back(v);
  }
  sort_unique(held);
  return held;
}

void require_held_rest(const ModelInputs& inputs, std::span<const int> held) {
  const std::vector<LoosePart> loose = loose_parts(inputs.mesh, held);
  if (!loose.empty())
    fail(
        "{}: of what is not in motion, {}; a larger `layers`, or another region of [cutting], would hold "
        "them",
        inputs.scene.source, to_text(loose.front()));
}

/// A part of the body while its matrices are made: mesh vertices, ascending.
struct PartNodes {
  std::vector<int> border;              ///< in motion, that share a tetrahedron with it
  std::vector<int> inner;               ///< condensed, that share one with the border
  std::vector<std::size_t> tetrahedra;  ///< that have both
};

/// K_rb of a part: rows by `rows` (mesh vertices), columns by its border.
SparseMatrix coupling_of(const ModelInputs& inputs, const PartNodes& part, const std::vector<int>& rows,
                         const std::vector<int>& part_of) {
  const TetMesh& mesh = inputs.mesh;
  const Moduli moduli = LinearLaw::moduli(*inputs.scene.material);
  Triplets entries;
  for (const std::size_t t : part.tetrahedra) {
    const Tetrahedron& corners = mesh.tetrahedra[t];
    std::array<Vec3, 4> x;
    for (std::size_t i = 0; i < 4; ++i) x[i] = mesh.vertices[static_cast<std::size_t>(corners[i])];
    const LinearTetrahedron element(x);
    const double weight = element.volume * (mesh.stiffness.empty() ? 1 : mesh.stiffness[t]);
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = 0; b < 4; ++b) {
        if (part_of[static_cast<std::size_t>(corners[a])] < 0 ||
            !std::ranges::binary_search(part.border, corners[b]))
          continue;
        const Mat3 block = weight * stiffness_per_volume(moduli, element.gradient[a], element.gradient[b]);
        const int row = 3 * place_in(rows, corners[a]), column = 3 * place_in(part.border, corners[b]);
        for (int i = 0; i < 9; ++i) entries.emplace_back(row + i % 3, column + i / 3, block(i % 3, i / 3));
      }
    }
  }
  SparseMatrix coupling(static_cast<Eigen::Index>(3 * rows.size()),
                        static_cast<Eigen::Index>(3 * part.border.size()));
  coupling.setFromTriplets(entries.begin(), entries.end());
  return coupling;
}

std::vector<PartNodes> nodes_of_parts(const TetMesh& mesh, const std::vector<int>& places,
                                      const std::vector<int>& part_of) {
  const auto count = static_cast<std::size_t>(1 + *std::ranges::max_element(part_of));
  std::vector<PartNodes> parts(count);
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    int part = -1;
    bool at_border = false;
    for (const int v : mesh.tetrahedra[t]) {
      part = std::max(part, part_of[static_cast<std::size_t>(v)]);
      at_border = at_border || places[static_cast<std::size_t>(v)] >= 0;
    }
    if (part < 0 || !at_border) continue;
    PartNodes& nodes = parts[static_cast<std::size_t>(part)];
    nodes.tetrahedra.push_back(t);
    for (const int v : mesh.tetrahedra[t]) {
      if (places[static_cast<std::size_t>(v)] >= 0) nodes.border.push_back(v);
      if (part_of[static_cast<std::size_t>(v)] >= 0) nodes.inner.push_back(v);
    }
  }
  for (PartNodes& nodes : parts) {
    sort_unique(nodes.border);
    sort_unique(nodes.inner);
  }
  return parts;
}

struct ModesOfPart {
  Eigen::ArrayXd squares;  ///< (k) angular frequencies squared
  Eigen::MatrixXd shapes;  ///< (unknowns x k), of unit mass
};

/// Returns the modes of one part of the modes of all together. Where parts swing alike, a mode may be of
/// several: what each part does in it is a mode of that, too.
ModesOfPart modes_of_part(const VibrationModes& all, const LinearStatics& statics,
                          const std::vector<int>& part_of, int part) {
  constexpr double kFraction = 1e-3;  // of a mode: less of it is rounding
  const Eigen::VectorXd masses = statics.masses();
  Eigen::VectorXd mine = Eigen::VectorXd::Zero(masses.size());
  for (std::size_t v = 0; v < part_of.size(); ++v) {
    if (part_of[v] == part) mine.segment<3>(statics.dofs.first[v]).setOnes();
  }
  ModesOfPart own{Eigen::ArrayXd(all.frequencies.size()),
                  Eigen::MatrixXd(masses.size(), all.frequencies.size())};
  const auto most = static_cast<Eigen::Index>(mine.sum()) / kUnknownsPerMode;
  Eigen::Index count = 0;
  for (Eigen::Index k = 0; k < all.frequencies.size() && count < most; ++k) {
    Eigen::VectorXd shape = all.shapes.col(k).cwiseProduct(mine);
    for (Eigen::Index j = 0; j < count; ++j)
      shape -= own.shapes.col(j).dot(masses.cwiseProduct(shape)) * own.shapes.col(j);
    const double norm = std::sqrt(shape.dot(masses.cwiseProduct(shape)));
    if (norm < kFraction) continue;
    own.squares[count] = all.frequencies[k] * all.frequencies[k];
    own.shapes.col(count++) = shape / norm;
  }
  own.squares.conservativeResize(count);
  own.shapes.conservativeResize(Eigen::NoChange, count);
  return own;
}

/// Returns what of the mass of a part, where its border goes as one piece, is not in its modes: kg, the mean
/// over three directions.
double mass_beside_modes(const LinearStatics& statics, const std::vector<int>& rows,
                         const SparseMatrix& coupling, const Eigen::MatrixXd& driven,
                         const Eigen::ArrayXd& squares) {
  Eigen::MatrixXd pull = Eigen::MatrixXd::Zero(statics.dofs.count, 3), together(coupling.cols(), 3);
  for (Eigen::Index b = 0; b < coupling.cols(); b += 3) together.middleRows<3>(b).setIdentity();
  const Eigen::MatrixXd at_rows = coupling * together;
  for (std::size_t i = 0; i < rows.size(); ++i)
    pull.middleRows<3>(statics.dofs.first[static_cast<std::size_t>(rows[i])]) =
        at_rows.middleRows<3>(3 * static_cast<Eigen::Index>(i));
  const Eigen::MatrixXd goes = statics.factor().solve(pull);
  const double all = goes.cwiseProduct(statics.masses().asDiagonal() * goes).sum();
  const Eigen::MatrixXd amplitudes = squares.inverse().matrix().asDiagonal() * (driven * together);
  return std::max(0.0, (all - amplitudes.squaredNorm()) / 3);
}

/// `mass` (kg) shared by the vertices of a border as the tetrahedra are that they share with the part.
std::vector<double> shared_mass(const TetMesh& mesh, const PartNodes& part, double mass) {
  std::vector<double> fraction(part.border.size(), 0);
  double all = 0;
  for (const std::size_t t : part.tetrahedra) {
    for (const int v : mesh.tetrahedra[t]) {
      if (!std::ranges::binary_search(part.border, v)) continue;
      const double volume = six_volumes(mesh, mesh.tetrahedra[t]);
      fraction[static_cast<std::size_t>(place_in(part.border, v))] += volume;
      all += volume;
    }
  }
  for (double& kg : fraction) kg *= mass / all;
  return fraction;
}

/// Returns, of (unknowns x k), the rows of these mesh vertices, three each.
Eigen::MatrixXd rows_of(const Eigen::MatrixXd& shapes, const LinearStatics& statics,
                        const std::vector<int>& vertices) {
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(3 * vertices.size()), shapes.cols());
  for (std::size_t i = 0; shapes.cols() > 0 && i < vertices.size(); ++i)
    rows.middleRows<3>(3 * static_cast<Eigen::Index>(i)) =
        shapes.middleRows<3>(statics.dofs.first[static_cast<std::size_t>(vertices[i])]);
  return rows;
}

}  // namespace

CondensedPart::CondensedPart(const ModelInputs& inputs, const std::vector<int>& places, const Modes& modes)
    : part_(inputs.surface.vertices.size(), -1),
      row_(part_),
      seen_(part_.size(), 0),
      damping_(inputs.scene.deformation.of<RayleighDamping>()) {
  const std::vector<int> held = held_by(inputs.fixed, places);
  require_held_rest(inputs, held);
  find_parts(inputs.mesh, held);
  if (all_.empty()) return;
  number_surface(inputs);
  const ModelInputs fixed_inputs{inputs.scene,     inputs.mesh,     inputs.surface,    held,
                                 inputs.reachable, inputs.progress, inputs.free_bytes, inputs.cache};
  const LinearStatics statics(fixed_inputs);
  const std::vector<PartNodes> nodes = nodes_of_parts(inputs.mesh, places, part_of_);
  VibrationModes found;
  const int count = std::min(modes.most, statics.dofs.count / kUnknownsPerMode);
  require_memory(8.0 * statics.dofs.count * (4.0 * count + 20), free_memory(), inputs.scene.source,
                 fmt::format("{} modes of what is not in motion", count), "ask for fewer `condensed_modes`");
  if (count > 0) found = statics.modes(count, inputs.scene.source);
  for (std::size_t p = 0; p < all_.size(); ++p) {
    Part& part = all_[p];
    for (const int v : nodes[p].border) part.border.push_back(3 * places[static_cast<std::size_t>(v)]);
    std::vector<int> rows = nodes[p].inner;
    for (const int vertex : part.surface)
      rows.push_back(inputs.surface.vertices[static_cast<std::size_t>(vertex)]);
    sort_unique(rows);
    const SparseMatrix coupling = coupling_of(inputs, nodes[p], rows, part_of_);
    const ModesOfPart own = modes_of_part(found, statics, part_of_, static_cast<int>(p));
    part.squares = own.squares;
    part.driven = -rows_of(own.shapes, statics, rows).transpose() * coupling;
    std::vector<int> surface;
    part.surface_rest.resize(static_cast<Eigen::Index>(3 * part.surface.size()));
    for (const int vertex : part.surface) {
      const int v = inputs.surface.vertices[static_cast<std::size_t>(vertex)];
      part.surface_rest.segment<3>(static_cast<Eigen::Index>(3 * surface.size())) =
          inputs.mesh.vertices[static_cast<std::size_t>(v)];
      surface.push_back(v);
    }
    part.shapes = rows_of(own.shapes, statics, surface).transpose();
    part.border_mass = shared_mass(inputs.mesh, nodes[p],
                                   mass_beside_modes(statics, rows, coupling, part.driven, part.squares));
    condense(inputs, statics, rows, coupling, part);
    take_modes_out(part);
  }
}

void CondensedPart::number_surface(const ModelInputs& inputs) {
  std::vector<char> is_corner(inputs.surface.vertices.size(), 0);  // else it is inside, until tissue goes
  for (const Triangle& triangle : inputs.surface.triangles) {
    for (const int v : triangle) is_corner[static_cast<std::size_t>(v)] = 1;
  }
  for (const int vertex : inputs.reachable) {
    if (is_corner[static_cast<std::size_t>(vertex)] == 0) continue;
    const int part = part_of(inputs.surface.vertices[static_cast<std::size_t>(vertex)]);
    if (part < 0) continue;
    auto& of_part = all_[static_cast<std::size_t>(part)].surface;
    part_[static_cast<std::size_t>(vertex)] = part;
    row_[static_cast<std::size_t>(vertex)] = static_cast<int>(3 * of_part.size());
    of_part.push_back(vertex);
    vertices_.push_back(vertex);
  }
  watched_.reserve(vertices_.size());
}

void CondensedPart::find_parts(const TetMesh& mesh, std::span<const int> held) {
  std::vector<char> condensed(mesh.vertices.size(), 1);
  for (const int v : held) condensed[static_cast<std::size_t>(v)] = 0;
  DisjointSets sets(mesh.vertices.size());
  for (const Tetrahedron& t : mesh.tetrahedra) {
    int first = -1;
    for (const int v : t) {
      if (condensed[static_cast<std::size_t>(v)] == 0) continue;
      if (first >= 0) sets.join(first, v);
      first = v;
    }
  }
  std::map<int, int> number;  // of sets, by their representatives
  part_of_.assign(mesh.vertices.size(), -1);
  for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
    if (condensed[static_cast<std::size_t>(v)] != 0)
      part_of_[static_cast<std::size_t>(v)] =
          number.emplace(sets.of(v), static_cast<int>(number.size())).first->second;
  }
  all_.resize(number.size());
}

/// B, T and W of a part from the rows and columns `rows` (mesh vertices) of K_rr^-1.
void CondensedPart::condense(const ModelInputs& inputs, const LinearStatics& statics,
                             const std::vector<int>& rows, const SparseMatrix& coupling, Part& part) {
  const auto size = static_cast<Eigen::Index>(3 * rows.size()), border = coupling.cols();
  const auto surface = static_cast<Eigen::Index>(3 * part.surface.size());
  require_memory(8.0 * static_cast<double>(size * (size + border) + 2 * border * (border + surface) +
                                           2 * surface * surface),
                 free_memory(), inputs.scene.source,
                 fmt::format("condensing what is not in motion to {} vertices", rows.size()),
                 "give [[tool]] a `reach` box around the part it touches");
  std::vector<int> unknowns;
  for (const int v : rows) {
    for (int axis = 0; axis < 3; ++axis)
      unknowns.push_back(statics.dofs.first[static_cast<std::size_t>(v)] + axis);
  }
  Eigen::MatrixXd inverse(size, size);
  statics.factor().inverse_block(
      unknowns, inverse, [&](double fraction) { inputs.progress(name_of(Stage::kCondensed), fraction); });
  const Eigen::MatrixXd moved = inverse * coupling;  // where the border takes them, with the other sign
  part.following = coupling.transpose() * moved;
  part.carrying.resize(border, surface);
  part.compliance.resize(surface, surface);
  std::vector<Eigen::Index> at;
  for (const int vertex : part.surface)
    at.push_back(3 * place_in(rows, inputs.surface.vertices[static_cast<std::size_t>(vertex)]));
  for (std::size_t i = 0; i < at.size(); ++i) {
    const auto row = 3 * static_cast<Eigen::Index>(i);
    part.carrying.middleCols<3>(row) = -moved.middleRows<3>(at[i]).transpose();
    for (std::size_t j = 0; j < at.size(); ++j)
      part.compliance.block<3, 3>(row, 3 * static_cast<Eigen::Index>(j)) = inverse.block<3, 3>(at[i], at[j]);
  }
}

/// Subtracts the modes from the static answer: what they do by themselves is no answer at once.
void CondensedPart::take_modes_out(Part& part) {
  const Eigen::Index border = part.following.cols(), count = part.squares.size();
  const Eigen::VectorXd inverse_frequencies = part.squares.rsqrt();
  const Eigen::MatrixXd driven = inverse_frequencies.asDiagonal() * part.driven,
                        shapes = inverse_frequencies.asDiagonal() * part.shapes;
  subtract_gram(driven, part.following);
  part.carrying.noalias() -= driven.transpose() * shapes;
  subtract_gram(shapes, part.compliance);
  part.at = part.bent = part.force = Eigen::VectorXd::Zero(border);
  part.p = part.p_v = part.p_bent = Eigen::VectorXd::Zero(count);
}

}  // namespace palpate::sim
