#include "sim_server/mesh/mesh_faults.h"

#include <algorithm>
#include <cmath>
#include <fmt/ranges.h>
#include <optional>
#include <utility>

#include "common/error.h"
#include "sim_server/mesh/bounding_box.h"
#include "sim_server/mesh/coincident_vertices.h"
#include "sim_server/mesh/connectivity.h"
#include "sim_server/mesh/cracks.h"
#include "sim_server/mesh/loose_parts.h"
#include "sim_server/mesh/surface.h"

namespace palpate::sim {
namespace {

// |6V| of a flat tetrahedron, relative to the cube of its longest edge: rounding leaves about 1e-16.
constexpr double kFlat = 1e-12;

std::string text(const Vec3& x) {
  return fmt::format("({:g}, {:g}, {:g})", x[0], x[1], x[2]);
}

double longest_edge(const TetMesh& mesh, const Tetrahedron& t) {
  double longest = 0;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < i; ++j)
      longest = std::max(longest, (mesh.vertices[t[i]] - mesh.vertices[t[j]]).norm());
  }
  return longest;
}

bool is_finite(const TetMesh& mesh, const Tetrahedron& t) {
  return std::ranges::all_of(t, [&](int v) { return mesh.vertices[v].allFinite(); });
}

/// The first vertex that stands twice in `t`, or -1.
int named_twice(Tetrahedron t) {
  std::ranges::sort(t);
  const auto twice = std::ranges::adjacent_find(t);
  return twice == t.end() ? -1 : *twice;
}

/// Collects what is found of each kind. `add` counts one; the first gives the example.
class Finds {
 public:
  explicit Finds(std::vector<MeshFault>& all) : all_(all) {}
  template <class Example>
  void add(Cure cure, const char* kind, const char* remedy, const Example& example, std::size_t count = 1) {
    auto fault = std::ranges::find_if(all_, [&](const MeshFault& f) { return f.kind == kind; });
    if (fault == all_.end()) fault = all_.insert(fault, {cure, 0, kind, example(), remedy});
    fault->count += count;
  }

 private:
  std::vector<MeshFault>& all_;
};

void find_missing(const TetMesh& mesh, Finds& finds) {
  if (mesh.tetrahedra.empty())
    finds.add(Cure::kRefused, "meshes without tetrahedra",
              "fill the surface first, as `gmsh -3 MODEL.geo` does",
              [] { return "no tetrahedra (4 nodes, Gmsh element type 4)"; });
  const auto n = static_cast<int>(mesh.vertices.size());
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    for (const int v : mesh.tetrahedra[e]) {
      if (v >= 0 && v < n) continue;
      finds.add(Cure::kRefused, "missing vertices", "export the mesh again", [&] {
        return fmt::format("tetrahedron {} names vertex {}, but the vertices are 0 to {}", e, v, n - 1);
      });
    }
  }
}

void drop_unused(TetMesh& mesh, Finds& finds) {
  std::vector<char> used(mesh.vertices.size(), 0);
  for (const Tetrahedron& t : mesh.tetrahedra) {
    for (const int v : t) used[v] = 1;
  }
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v] != 0) continue;
    finds.add(Cure::kMended, "unused vertices", "dropped", [&] {
      return fmt::format("vertex {} of all, at {}, belongs to no tetrahedron", v, text(mesh.vertices[v]));
    });
  }
  keep_vertices(mesh, used);
}

/// The same vertices the same way round: `t` sorted, but for the last two.
Tetrahedron turned_to_sorted(Tetrahedron t) {
  bool odd = false;
  for (int i = 0; i < 3; ++i) {
    const auto least = std::min_element(t.begin() + i, t.end());
    if (least == t.begin() + i) continue;
    std::iter_swap(least, t.begin() + i);
    odd = !odd;
  }
  if (odd) std::swap(t[2], t[3]);
  return t;
}

void drop_repeated(TetMesh& mesh, Finds& finds) {
  std::vector<std::pair<Tetrahedron, std::size_t>> sorted;
  for (const Tetrahedron& t : mesh.tetrahedra) sorted.emplace_back(turned_to_sorted(t), sorted.size());
  std::ranges::sort(sorted);
  std::vector<char> is_copy(sorted.size(), 0);
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    if (sorted[i].first != sorted[i - 1].first) continue;
    const std::size_t copy = sorted[i].second;
    is_copy[copy] = 1;
    finds.add(Cure::kMended, "repeated tetrahedra", "dropped", [&] {
      return fmt::format("tetrahedron {} of all (vertices {}) is tetrahedron {} again", copy,
                         fmt::join(mesh.tetrahedra[copy], " "), sorted[i - 1].second);
    });
  }
  std::size_t e = 0;
  std::erase_if(mesh.tetrahedra, [&](const Tetrahedron&) { return is_copy[e++] != 0; });
}

void find_not_finite(const TetMesh& mesh, Finds& finds) {
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (mesh.vertices[v].allFinite()) continue;
    finds.add(Cure::kRefused, "vertices that are nowhere", "export the mesh again", [&] {
      return fmt::format("vertex {} is at {}: every coordinate must be a finite number", v,
                         text(mesh.vertices[v]));
    });
  }
}

std::string unsound(const TetMesh& mesh, std::size_t e, const char* how) {
  const Tetrahedron& t = mesh.tetrahedra[e];
  const std::vector<Vec3>& x = mesh.vertices;
  return fmt::format("tetrahedron {} (vertices {}) is {}: volume {:.3g} m^3 at {} {} {} {}", e,
                     fmt::join(t, " "), how, six_volumes(mesh, t) / 6, text(x[t[0]]), text(x[t[1]]),
                     text(x[t[2]]), text(x[t[3]]));
}

/// Turns all tetrahedra round where all are inverted: then the file lists vertices in another order, and
/// nothing is wrong with the places. A single one may be a slip.
void turn_round(TetMesh& mesh, Finds& finds) {
  const auto is_inverted = [&](const Tetrahedron& t) {
    return named_twice(t) < 0 && is_finite(mesh, t) && six_volumes(mesh, t) < 0;
  };
  if (mesh.tetrahedra.size() < 2 || !std::ranges::all_of(mesh.tetrahedra, is_inverted)) return;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    std::swap(mesh.tetrahedra[e][2], mesh.tetrahedra[e][3]);
    finds.add(Cure::kMended, "tetrahedra the other way round", "turned round",
              [&] { return "all tetrahedra list their vertices in the other order"; });
  }
}

/// Also turns inverted tetrahedra round in `upright`, a copy of `mesh`.
void find_unsound(const TetMesh& mesh, Finds& finds, TetMesh& upright) {
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const Tetrahedron& t = mesh.tetrahedra[e];
    if (const int twice = named_twice(t); twice >= 0) {
      finds.add(Cure::kRefused, "tetrahedra with a vertex twice", "remove it or re-mesh",
                [&] { return fmt::format("tetrahedron {} names vertex {} twice", e, twice); });
      continue;
    }
    if (!is_finite(mesh, t)) continue;
    const double six_v = six_volumes(mesh, t);
    if (!(std::abs(six_v) > kFlat * std::pow(longest_edge(mesh, t), 3))) {  // so that NaN is flat
      finds.add(Cure::kRefused, "flat tetrahedra", "re-mesh, or move a vertex",
                [&] { return unsound(mesh, e, "flat"); });
    } else if (six_v < 0) {
      finds.add(Cure::kRefused, "inverted tetrahedra", "swap two of its vertices",
                [&] { return unsound(mesh, e, "inverted"); });
      std::swap(upright.tetrahedra[e][2], upright.tetrahedra[e][3]);
    }
  }
}

void find_bodies(const TetMesh& mesh, Finds& finds) {
  constexpr std::size_t kShown = 20;  // bodies: the message stays one line
  const std::vector<int> sizes = body_sizes(mesh);
  if (sizes.size() == 1) return;
  const std::vector<int> shown(sizes.begin(), sizes.begin() + std::min(kShown, sizes.size()));
  finds.add(
      Cure::kRefused, "bodies", "join them, or keep one (in Gmsh, save one physical volume)",
      [&] {
        return fmt::format("{} bodies that share no vertex, of {}{} tetrahedra, but the organ is one body",
                           sizes.size(), fmt::join(shown, ", "), sizes.size() > kShown ? ", ..." : "");
      },
      sizes.size());
}

/// The part with fewer tetrahedra is the one that hangs on the other.
std::string text_of(const TetMesh& mesh, const Hinge& hinge) {
  constexpr std::size_t kShown = 6;  // vertices: the message stays one line
  const auto& on = hinge.vertices;
  const std::vector<int> shown(on.begin(), on.begin() + std::min(kShown, on.size()));
  const auto [fewer, more] = std::minmax(hinge.tetrahedra[0], hinge.tetrahedra[1]);
  return fmt::format("parts of {} and {} tetrahedra are joined by {} {}{} alone, at {}{}", more, fewer,
                     on.size() == 1 ? "vertex" : "vertices", fmt::join(shown, " "),
                     on.size() > kShown ? " ..." : "", text(mesh.vertices[on.front()]),
                     on.size() == 1 ? "" : " to " + text(mesh.vertices[on.back()]));
}

void find_hinges(const TetMesh& mesh, Finds& finds) {
  for (const Hinge& hinge : hinges(mesh))
    finds.add(Cure::kAccepted, "hinges",
              "one can turn against the other: hold each by a [[fixed]] of its own, or join them over a face",
              [&] { return text_of(mesh, hinge); });
}

double middle_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The worst is the example. The shortest height h tells what slivers cost: they are stiff as 1/h on masses
/// that they share with their neighbours, so that the highest frequency goes as the root of that; with
/// damping in proportion to the stiffness, sub-steps go as its square. Measured on a liver of 16584
/// tetrahedra with a height of 0.0086 of the median: 19 and 110 times the sub-steps of a mesh without
/// slivers.
void find_slivers(const TetMesh& mesh, std::vector<MeshFault>& all) {
  std::size_t count = 0, worst = 0;
  double least = kSliver;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const double angle = smallest_dihedral(mesh, mesh.tetrahedra[e]);
    if (!(angle < kSliver)) continue;
    ++count;
    if (!(angle < least)) continue;
    least = angle;
    worst = e;
  }
  if (count == 0) return;
  std::vector<double> heights;
  for (const Tetrahedron& t : mesh.tetrahedra) heights.push_back(shortest_height(mesh, t));
  const double middle = middle_of(heights);
  const double shortest = *std::ranges::min_element(heights);
  all.push_back(
      {Cure::kAccepted, count, "slivers",
       fmt::format(
           "tetrahedron {} (vertices {}) at {} has a dihedral angle of {:.2g} degrees, below {:.0f}; the "
           "shortest height of all is {:.2g} mm, {:.2g} of the median: explicit steps need some "
           "{:.0f} times the sub-steps (with `rayleigh_stiffness` up to {:.0f} times), and equations are "
           "as much as {:.0f} times worse conditioned",
           worst, fmt::join(mesh.tetrahedra[worst], " "), text(mesh.vertices[mesh.tetrahedra[worst][0]]),
           least / kDegree, kSliver / kDegree, 1e3 * shortest, shortest / middle,
           std::sqrt(middle / shortest), middle / shortest, middle / shortest),
       "mesh it again with optimisation (Gmsh: `-optimize_netgen`), its surface too if that has slivers "
       "(`ClassifySurfaces`)"});
}

void find_outer_faces_on_others(const TetMesh& mesh, std::span<const Triangle> faces, Finds& finds) {
  const double same_place = kSamePlace * diagonal_of(mesh.vertices);
  const Cracks cracks = find_cracks(mesh, faces, same_place);
  if (cracks.faces > 0)
    finds.add(
        Cure::kRefused, "outer faces on others: a crack",
        "mesh all of it at once (`BooleanFragments` in Gmsh), so that the faces match; or move the sides of "
        "a slit "
        "apart by more than a millionth of an edge",
        [&] {
          return fmt::format(
              "{:.3g} mm2 of the surface lie on other surface, as at {}: parts that were meshed apart "
              "touch there and do not hang together",
              1e6 * cracks.area, text(cracks.place));
        },
        cracks.faces);
}

void find_surface_faults(const TetMesh& mesh, Finds& finds) {
  const OuterFaces faces = outer_faces(mesh);
  for (const OverlappingFace& face : faces.overlaps)
    finds.add(Cure::kRefused, "faces where tetrahedra overlap", "remove the tetrahedra that overlap",
              [&] { return describe(face); });
  if (!faces.overlaps.empty()) return;  // then it is not a closed surface
  const NonManifold meets = non_manifold(faces.triangles);
  if (meets.edges > 0)
    finds.add(
        Cure::kAccepted, "edges on more than two triangles", "",
        [&] {
          return fmt::format("the surface meets itself along the edge from {} to {}",
                             text(mesh.vertices[meets.edge[0]]), text(mesh.vertices[meets.edge[1]]));
        },
        meets.edges);
  if (meets.vertices > 0)
    finds.add(
        Cure::kAccepted, "vertices of several sheets", "",
        [&] { return fmt::format("the surface meets itself at {}", text(mesh.vertices[meets.vertex])); },
        meets.vertices);
  if (meets.edges + meets.vertices > 0) find_hinges(mesh, finds);
}

}  // namespace

bool MeshFaults::refused() const {
  return std::ranges::any_of(found, [](const MeshFault& f) { return f.cure == Cure::kRefused; });
}

MeshFaults mend(TetMesh& mesh) {
  MeshFaults faults;
  Finds finds(faults.found);
  find_missing(mesh, finds);
  if (faults.refused()) {
    faults.surface_seen = false;
    return faults;
  }
  drop_unused(mesh, finds);
  drop_repeated(mesh, finds);
  find_not_finite(mesh, finds);
  const bool finite = !faults.refused();
  turn_round(mesh, finds);
  TetMesh upright = mesh;
  find_unsound(mesh, finds, upright);
  faults.surface_seen = std::ranges::all_of(faults.found, [](const MeshFault& f) {
    return f.cure == Cure::kMended || f.kind == "inverted tetrahedra";
  });
  if (finite) {
    const Coincidence coincidence = merge_coincident(mesh, !faults.refused());
    const bool merged = coincidence.remedy.empty();
    if (coincidence.vertices > 0)
      faults.found.push_back({merged ? Cure::kMended : Cure::kRefused, coincidence.vertices,
                              "vertices where there is one already", coincidence.example,
                              merged ? "merged" : coincidence.remedy});
    if (merged && coincidence.vertices > 0) upright = mesh;
  }
  find_bodies(mesh, finds);
  const bool sound = !faults.refused();
  if (faults.surface_seen) find_surface_faults(upright, finds);
  if (sound && !faults.refused()) find_outer_faces_on_others(mesh, outer_faces(mesh).triangles, finds);
  if (!faults.refused()) find_slivers(mesh, faults.found);
  return faults;
}

void require_usable(const MeshFaults& faults, const std::string& source) {
  const auto refused = [](const MeshFault& f) { return f.cure == Cure::kRefused; };
  const auto first = std::ranges::find_if(faults.found, refused);
  if (first == faults.found.end()) return;
  const auto kinds = std::ranges::count_if(faults.found, refused);
  const bool each = first->count > 1 && first->kind != "bodies";
  fail("{}: {}{}; {}{}", source, first->example,
       each ? fmt::format(", the first of {} {}", first->count, first->kind) : "", first->remedy,
       kinds > 1 ? fmt::format(" (the first of {} kinds of faults: `sim_server mesh info` lists all)", kinds)
                 : "");
}

std::string odd_size(const TetMesh& mesh) {
  constexpr double kLongest = 5, kShortest = 0.005;  // m
  if (mesh.vertices.empty()) return {};
  const double size = bounding_box(mesh.vertices).sizes().maxCoeff();
  if (size > kLongest)
    return fmt::format(
        "the mesh is {:.3g} m long; is its unit the millimetre? then set `scale = 0.001` in [mesh]", size);
  if (size < kShortest)
    return fmt::format("the mesh is {:.3g} m long; if its unit is not the metre, set `scale` in [mesh]",
                       size);
  return {};
}

std::string slivers_in_short(const MeshFaults& faults) {
  for (const MeshFault& f : faults.found) {
    if (f.kind == "slivers")
      return fmt::format("{}{}; {}", f.example, f.count > 1 ? fmt::format(", the worst of {}", f.count) : "",
                         f.remedy);
  }
  return "";
}

std::string mended_in_short(const MeshFaults& faults) {
  std::string line;
  for (const MeshFault& f : faults.found) {
    if (f.cure == Cure::kMended)
      line += fmt::format("{}{} ({}) {}", line.empty() ? "" : ", ", f.kind, f.count, f.remedy);
  }
  return line;
}

}  // namespace palpate::sim
