#pragma once
/// Scene as read from its file, section by section. An absent section means: not built.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/contact/tool.h"
#include "sim_server/elasticity/material.h"
#include "sim_server/scene/cutting.h"
#include "sim_server/scene/deformation_settings.h"
#include "sim_server/scene/regions.h"
#include "sim_server/scene/tool_reach.h"
#include "sim_server/sparse/stiffness_matrix.h"

namespace palpate::sim {

/// `[[fixed.motion]]`: the displacement direction x amplitude x sin(2 pi t / period + phase), t the time of
/// the simulation, which begins at 0.
struct SupportMotion {
  Vec3 direction;    ///< unit, world
  double amplitude;  ///< m, [0, 1]
  double period;     ///< s, [0.01, 1e4]
  double phase = 0;  ///< rad, [-1e3, 1e3]
};

/// `[[fixed]]`: mesh vertices that the tissue does not move.
struct FixedRegion : Region {
  HeldAxes axes = kAllAxes;              ///< along which
  std::vector<SupportMotion> motions{};  ///< prescribed, added up; none: they rest

  bool moves() const { return !motions.empty(); }
};

/// `[[material.inclusion]]`: a part of the tissue, as the mesh resolves it, that differs by how stiff it is.
struct Inclusion : Region {
  double young_modulus = 0;  ///< Pa, [1e-3, 1e12]; fibres in it are stiffer by as much
};

/// `[[load]]`: what acts on the tissue besides tools.
struct Load {
  enum class Kind {
    kGravity,   ///< `vector`: m/s^2, on all of it
    kTraction,  ///< `vector`: Pa of the area at rest, on the boundary triangles whose corners are in
                ///< `region`, or that its tag names
    kPressure,  ///< `pressure`, on the same; of all but the linear law it turns and grows with the surface
    kForce,     ///< `vector`: N in all, shared equally by the vertices of `region`
    kDisplacement,  ///< `vector`: m from rest, where the vertices of `region` are held
  };
  Kind kind;
  Region region{};
  Vec3 vector = Vec3::Zero();
  HeldAxes axes = kAllAxes;  ///< of a displacement: along which
  double pressure = 0;       ///< Pa, against the outward normal
};

/// Settings of one `[[tool]]`.
struct ToolSettings {
  Tool shape;
  std::optional<Reach> reach;  ///< absent: the whole organ
  std::string where;           ///< "FILE:LINE" of this section
  std::string reach_where;     ///< "FILE:LINE" of what tells `reach`; empty where it is absent
  bool stays_within = false;   ///< `reach` is of its tip, by [tool.workspace] or [tool.cone]: leaving warns
  /// Buttons of which any, while pressed, makes it hold the surface near it; 0: none does, [0, 65535].
  std::uint16_t grasp_buttons = 0;
  std::optional<Vec3> grasp_place{};  ///< tool centre, m, from where it holds the resting surface always
  std::string grasp_where{};          ///< "FILE:LINE" of either; empty where both are absent
  std::uint16_t cut_buttons = 0;      ///< of which any, while pressed, makes it cut; 0: none does, [0, 65535]
  std::string cut_where{};            ///< "FILE:LINE" of that; empty where it is absent
  /// The end of its sharp edge, m, in its own frame; the edge begins at the centre of its tip. None: it cuts
  /// by heat.
  std::optional<Vec3> blade{};
  std::string blade_where{};  ///< "FILE:LINE" of that; empty where it is absent
  bool grasps() const { return grasp_buttons != 0 || grasp_place.has_value(); }
};

struct Scene {
  std::string title;
  double rate_hz = 30;     ///< steps per second, 0 or [1, 10000]; 0 = as fast as the model allows
  std::string rate_where;  ///< "FILE:LINE" of `rate_hz`; empty where it is absent
  std::filesystem::path mesh_file;
  std::string mesh_where;  ///< "FILE:LINE" of `[mesh] file`
  double mesh_scale = 1;   ///< metres per unit of the mesh file, [1e-6, 1e3]
  /// Number of times that each tetrahedron of the file is `refined`, into eight; and `halved` for a half. 0,
  /// 0.5, ... 2.
  double mesh_refinements = 0;
  std::vector<FixedRegion> fixed;
  std::vector<Load> loads{};
  std::optional<Material> material;
  std::vector<Inclusion> inclusions{};
  std::optional<Cutting> cutting{};  ///< absent: nothing is cut
  std::string material_where;        ///< "FILE:LINE" of `[material]`; empty where it is absent
  DeformationSettings deformation;
  std::vector<ToolSettings> tools = std::vector<ToolSettings>(1);  ///< 1 to `kMaxTools`
  /// Client files made for this scene, one per tool; the server itself does not read them.
  std::vector<std::filesystem::path> clients{};
  std::string source;  ///< the file, for messages

  /// The first tool that cuts by a blade; null: none does.
  const ToolSettings* blade() const {
    const auto found = std::ranges::find_if(tools, [](const auto& tool) { return tool.blade.has_value(); });
    return found == tools.end() ? nullptr : &*found;
  }
  /// True if nothing holds the body anywhere.
  bool flies() const {
    const auto displaces = [](const Load& load) { return load.kind == Load::Kind::kDisplacement; };
    return fixed.empty() && std::ranges::none_of(loads, displaces);
  }
};

/// The mesh file that the scene names, in metres, with a warning where it is of no size that an organ has.
/// Scaled and refined. Throws `Error` as `read_mesh`.
TetMesh read_mesh_of(const Scene& scene);

/// Mesh vertices that the scene fixes, ascending. Throws `Error` for a region that holds no vertex or an
/// unknown tag, and where no vertex of tissue is left free.
std::vector<int> fixed_vertices(const Scene& scene, const TetMesh& mesh);

}  // namespace palpate::sim
