#pragma once
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "sim_server/mesh/cut_mesh.h"
#include "sim_server/tissue/deformation_model.h"

namespace palpate::sim {

/// The sharp edge of a blade (m, world): from one end to the other.
using BladeEdge = std::array<Vec3, 2>;

/// Path of a blade through tissue.
struct BladeSweep {
  BladeEdge was, is;
  /// Vector from its former place to the end of its trail, m; 0 at the start. The trail follows the blade as
  /// if dragged on a string (a tractrix), so that tissue that trembles does not turn its path.
  Vec3 trail = Vec3::Zero();
};

/// Effect of a blade on tissue.
struct Stroke {
  bool moved = false;                             ///< far enough to be looked at
  Vec3 motion = Vec3::Zero();                     ///< of the blade through the tissue around it, m
  Vec3 trail = Vec3::Zero();                      ///< from where it is now, m
  std::vector<CuttableModel::Slide> slides = {};  ///< in order; done
  std::vector<int> faces = {};                    ///< to be parted then, 4 t + k, each once
  bool at_end = false;                            ///< the blade went into tissue that cannot be cut
};

/// Finds the faces that a blade parts in a mesh of tetrahedra: those between tetrahedra whose centres lie on
/// two sides of its path. First the vertices next to its way slide onto it along the edges that cross it, a
/// little ahead of it, so that the cut is smooth (Nienhuys and van der Stappen 2001, who also part faces and
/// slide vertices; which faces these are is found here by the line between the two centres, so that all of
/// the way is parted, whatever could slide). A vertex slides once, by at most half of the edge, on the
/// surface along that; it does not where an element would get too flat, or the body another volume. One
/// thread; allocates.
class Scalpel {
 public:
  /// O(tetrahedra).
  explicit Scalpel(const CutMesh& mesh);

  /// Sets the mesh vertices that do not slide in the next `cut`s.
  void keep(std::vector<int> vertices) { stored_ = std::move(vertices); }
  /// The mean edge of what can be cut, at rest, m.
  double size() const { return edge_; }

  /// Returns the effect of a blade on this path. `were`, `are`: the surface vertices when it was where it
  /// was, and now, m. Slides vertices of the mesh, and of both. Nothing where it has hardly moved: it is to
  /// be asked again, from where it was. O(tetrahedra).
  Stroke cut(const BladeSweep& blade, std::span<Vec3> were, std::span<Vec3> are, CutMesh& mesh);

  std::size_t bytes() const { return slid_.size(); }

 private:
  /// Plane of the blade's path, near its edge.
  struct Plane {
    Vec3 origin, along, ahead, normal;  // of its edge: one end; to the other; where it goes; unit
    double length, back;                // of the edge; that it has come, m
  };
  struct Crossing {
    int vertex, towards;
    double fraction, far;  // of the edge; m
  };
  std::vector<int> around(const BladeEdge& was, const BladeEdge& is, std::span<const Vec3> are,
                          const CutMesh& mesh) const;
  std::vector<Crossing> crossings(const Plane& plane, std::span<const int> near, std::span<const Vec3> are,
                                  const CutMesh& mesh) const;
  bool stays(int vertex) const;
  bool may_slide(const Crossing& crossing, const CutMesh& mesh) const;
  bool slide(const Crossing& crossing, CutMesh& mesh) const;
  void slide_onto(const Plane& plane, std::span<const int> near, std::span<Vec3> were, std::span<Vec3> are,
                  CutMesh& mesh, std::vector<CuttableModel::Slide>& slides);
  void find_faces(const BladeSweep& blade, std::span<const int> near, std::span<const Vec3> were,
                  std::span<const Vec3> are, const CutMesh& mesh, Stroke& stroke) const;

  double edge_ = 0, longest_ = 0, height_ = 0;  // m: of edges the mean and the longest; of heights the mean
  std::vector<char> slid_;                      // of mesh vertices
  std::vector<int> stored_;
};

}  // namespace palpate::sim
