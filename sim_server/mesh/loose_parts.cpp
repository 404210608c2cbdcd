#include "sim_server/mesh/loose_parts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <fmt/core.h>

#include "sim_server/mesh/disjoint_sets.h"

namespace palpate::sim {
namespace {

constexpr double kInLine = 1e-6;  // sine of an angle below which three places are in one line

/// (m) The part of each tetrahedron, numbered from 0: those that share a face are of one.
std::vector<int> part_of_tetrahedra(const TetMesh& mesh) {
  struct Face {
    std::array<int, 3> vertices;
    int tetrahedron;
  };
  std::vector<Face> faces;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    for (int skip = 0; skip < 4; ++skip) {
      Face face{{}, static_cast<int>(t)};
      for (int i = 0, k = 0; i < 4; ++i) {
        if (i != skip) face.vertices[k++] = mesh.tetrahedra[t][i];
      }
      std::ranges::sort(face.vertices);
      faces.push_back(face);
    }
  }
  std::ranges::sort(faces, {}, &Face::vertices);
  DisjointSets parts(mesh.tetrahedra.size());
  for (std::size_t f = 1; f < faces.size(); ++f) {
    if (faces[f].vertices == faces[f - 1].vertices)
      parts.join(faces[f].tetrahedron, faces[f - 1].tetrahedron);
  }
  return parts.numbers();
}

LoosePart::Hold hold_of(const std::vector<Vec3>& places, bool& holds) {
  holds = false;
  if (places.empty()) return LoosePart::Hold::kNone;
  Vec3 line = Vec3::Zero();
  for (const Vec3& p : places) {
    const Vec3 from = p - places.front();
    if (from.squaredNorm() > line.squaredNorm()) line = from;
  }
  if (line.isZero(0)) return LoosePart::Hold::kPlace;
  for (const Vec3& p : places)
    holds = holds || line.cross(p - places.front()).norm() > kInLine * line.squaredNorm();
  return LoosePart::Hold::kLine;
}

/// Two parts, the lower number first, and a vertex of both.
struct Joint {
  std::array<int, 2> parts;
  int vertex;
  auto operator<=>(const Joint&) const = default;  // NOLINT(modernize-use-nullptr): it is none
};

/// All of them, in order. Where many parts meet in a vertex, only those of neighbouring numbers.
std::vector<Joint> joints_of(const TetMesh& mesh, const std::vector<int>& part) {
  constexpr std::ptrdiff_t kMany =
      16;  // parts: up to 120 pairs at a vertex, beyond which work would be quadratic
  std::vector<std::pair<int, int>> uses;  // vertex, part
  for (std::size_t t = 0; t < part.size(); ++t) {
    for (const int v : mesh.tetrahedra[t]) uses.emplace_back(v, part[t]);
  }
  std::ranges::sort(uses);
  uses.erase(std::unique(uses.begin(), uses.end()), uses.end());
  std::vector<Joint> joints;
  for (auto first = uses.begin(); first != uses.end();) {
    const auto last =
        std::find_if(first, uses.end(), [&](const auto& use) { return use.first != first->first; });
    const std::ptrdiff_t around = last - first > kMany ? 1 : last - first;
    for (auto a = first; a != last; ++a) {
      for (auto b = a + 1; b != last && b - a <= around; ++b)
        joints.push_back({{a->second, b->second}, first->first});
    }
    first = last;
  }
  std::ranges::sort(joints);
  return joints;
}

/// Calls `work(parts, vertices)` for each two parts that share some.
template <class Work>
void for_pairs(const std::vector<Joint>& joints, const Work& work) {
  for (auto first = joints.begin(); first != joints.end();) {
    std::vector<int> vertices;
    auto joint = first;
    for (; joint != joints.end() && joint->parts == first->parts; ++joint) vertices.push_back(joint->vertex);
    work(first->parts, vertices);
    first = joint;
  }
}

}  // namespace

std::vector<Hinge> hinges(const TetMesh& mesh) {
  std::vector<int> part = part_of_tetrahedra(mesh);
  std::vector<Joint> joints;
  for (bool joined = true; joined;) {
    joined = false;
    const int count = part.empty() ? 0 : 1 + *std::ranges::max_element(part);
    if (count < 2) return {};
    DisjointSets parts(static_cast<std::size_t>(count));
    joints = joints_of(mesh, part);
    for_pairs(joints, [&](const std::array<int, 2>& two, const std::vector<int>& vertices) {
      std::vector<Vec3> places;
      for (const int v : vertices) places.push_back(mesh.vertices[v]);
      bool holds = false;
      hold_of(places, holds);
      if (holds) joined |= parts.join(two[0], two[1]);
    });
    const std::vector<int> number = parts.numbers();
    for (int& p : part) p = number[p];
  }
  std::vector<std::size_t> size(static_cast<std::size_t>(1 + std::ranges::max(part)), 0);
  for (const int p : part) ++size[static_cast<std::size_t>(p)];
  std::vector<Hinge> found;
  for_pairs(joints, [&](const std::array<int, 2>& two, const std::vector<int>& vertices) {
    found.push_back(
        {{size[static_cast<std::size_t>(two[0])], size[static_cast<std::size_t>(two[1])]}, vertices});
  });
  return found;
}

namespace {

/// Parts that hang together by whole faces, and which of them are held.
struct HeldParts {
  std::vector<int> part;        // of each tetrahedron
  std::vector<LoosePart> each;  // as if it were loose
  std::vector<char> is_held;
};

HeldParts held_parts(const TetMesh& mesh, std::span<const int> held) {
  HeldParts found{part_of_tetrahedra(mesh), {}, {}};
  const int parts = found.part.empty() ? 0 : 1 + *std::ranges::max_element(found.part);
  std::vector<std::vector<int>> vertices(static_cast<std::size_t>(parts));  // of each part
  found.each.resize(static_cast<std::size_t>(parts));
  for (std::size_t t = 0; t < found.part.size(); ++t) {
    auto& own = vertices[found.part[t]];
    own.insert(own.end(), mesh.tetrahedra[t].begin(), mesh.tetrahedra[t].end());
    ++found.each[found.part[t]].tetrahedra;
  }
  for (auto& own : vertices) {
    std::ranges::sort(own);
    own.erase(std::unique(own.begin(), own.end()), own.end());
  }
  std::vector<char> is_placed(mesh.vertices.size(), 0);
  found.is_held.assign(vertices.size(), 0);
  for (const int v : held) is_placed[v] = 1;
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t p = 0; p < vertices.size(); ++p) {
      if (found.is_held[p] != 0) continue;
      std::vector<Vec3> places;
      for (const int v : vertices[p]) {
        if (is_placed[v] != 0) places.push_back(mesh.vertices[v]);
      }
      bool holds = false;
      found.each[p].hold = hold_of(places, holds);
      found.each[p].place = places.empty() ? mesh.vertices[vertices[p].front()] : places.front();
      if (!holds) continue;
      found.is_held[p] = 1;
      changed = true;
      for (const int v : vertices[p]) is_placed[v] = 1;
    }
  }
  return found;
}

}  // namespace

std::vector<LoosePart> loose_parts(const TetMesh& mesh, std::span<const int> held) {
  const HeldParts parts = held_parts(mesh, held);
  std::vector<LoosePart> loose;
  for (std::size_t p = 0; p < parts.each.size(); ++p) {
    if (parts.is_held[p] == 0) loose.push_back(parts.each[p]);
  }
  std::ranges::stable_sort(loose, std::greater<>(), &LoosePart::tetrahedra);
  return loose;
}

void drop_loose_parts(TetMesh& mesh, std::span<const int> held) {
  const HeldParts parts = held_parts(mesh, held);
  keep_tetrahedra(mesh, [&](std::size_t t) { return parts.is_held[parts.part[t]] != 0; });
}

std::string to_text(const LoosePart& part) {
  const std::string_view by = part.hold == LoosePart::Hold::kNone    ? "are held by nothing, as at"
                              : part.hold == LoosePart::Hold::kPlace ? "can turn about the one place"
                                                                     : "hang on a hinge at";
  return fmt::format("{} tetrahedra {} {:.4g},{:.4g},{:.4g}", part.tetrahedra, by, part.place[0],
                     part.place[1], part.place[2]);
}

}  // namespace palpate::sim
