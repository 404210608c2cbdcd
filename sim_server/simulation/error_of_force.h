#pragma once
#include "common/error_mean.h"
#include "sim_server/simulation/mesh_resolution.h"
#include "sim_server/simulation/simulation.h"
#include "sim_server/simulation/thin_tissue.h"

namespace palpate::sim {

/// Errors that a study of a scene measured, and where: they hold near there alone.
struct StudiedErrors {
  DiscretisationErrors errors;
  Box pressed;             ///< of the places of the tool in contact, m
  double most_newton = 0;  ///< largest force on the tool, N
};

/// Errors of the force on each tool by mesh and time step. Measured where a study of the scene has pressed,
/// within a radius of the tool of where it did, and up to 1.5 times as hard. Elsewhere the mesh's share
/// is estimated in each step: the larger of what a table says of how fine it is where the tool presses
/// (`estimated_mesh_error`) and, of linear elements, of the nearest press at set-up in such a direction
/// (`ElementTrial`), of a tool with the radius of the first. Of tissue that bends (`ThinTissue`), or that is
/// all but incompressible (`Material::locks`), the table says nothing: without a press on such it is unknown.
/// That of the time step is unknown, but where the force follows from the poses of the step alone, so that no
/// step is too long. One thread.
class ErrorOfForce {
 public:
  /// `studied`: of this scene, pressed with its first tool. `simulation` is read here only. O(vertices x
  /// tools).
  ErrorOfForce(const Scene& scene, const Simulation& simulation,
               const std::optional<StudiedErrors>& studied = {});

  /// Returns the errors of a step in which a tool loads the surface so. O(loads); does not allocate.
  DiscretisationErrors of_step(std::size_t tool, std::span<const VertexLoad> loads) const noexcept;
  /// Adds a step with a force of `newton` (N) on the tool, which is then part of `elements_per_radius` and
  /// `of_all_steps`.
  void add_step(std::size_t tool, std::span<const VertexLoad> loads, double newton) noexcept {
    tools_[tool].mesh.add(loads);
    tools_[tool].steps.add(of_step(tool, loads), newton);
  }

  /// Elements to a radius of a tool that can press, where the mesh is finest of what it can touch; nothing
  /// where no mesh of elements is touched so.
  std::optional<double> finest(std::size_t tool, std::span<const Triangle> touchable) const;
  /// Mean where a tool has pressed; nothing before it has.
  std::optional<double> elements_per_radius(std::size_t tool) const noexcept {
    return tools_[tool].mesh.elements_per_radius();
  }
  /// Number of places where set-up has pressed on both kinds of elements.
  std::size_t presses() const noexcept { return trials_.size(); }
  /// Why there are none, and what helps, for a user; empty where there are some, or elements do not matter.
  const std::string& why_no_press() const noexcept { return why_no_press_; }
  std::size_t bytes() const noexcept;
  /// Returns the mean errors over all steps so far, each by the size of its force.
  DiscretisationErrors of_all_steps(std::size_t tool) const noexcept { return tools_[tool].steps.mean(); }

 private:
  void add_trials(const Scene& scene, const Simulation& simulation);
  std::optional<double> by_table(std::size_t tool, std::span<const VertexLoad> loads) const noexcept;
  /// Sum of the loads of a tool, N, and their middle by force, at rest, m.
  struct Load {
    Vec3 middle, force;
  };
  std::optional<double> by_trial(const Load& load, bool thin) const noexcept;
  std::optional<Load> sum_of_loads(std::span<const VertexLoad> loads) const noexcept;
  bool was_studied(std::size_t tool, const Load& load) const noexcept;

  struct OfTool {
    DiscretisationErrors known;          // whatever it touches
    std::optional<ElementKind> element;  // for the table; nothing where it says nothing
    bool tried;                          // the trials are of such a tool
    MeshResolution mesh;
    ErrorMeans steps = {};
  };
  /// Errors that a study measured, and the place and the force up to which they hold.
  struct Studied {
    DiscretisationErrors errors;
    Box near;  // where it pressed, at rest, m
    double most_newton;
  };
  struct Trial {
    Load load;
    bool thin;  // on tissue that bends
    double percent;
  };
  std::vector<Vec3> rest_;  // the surface vertices, m
  std::vector<OfTool> tools_;
  std::optional<Studied> studied_;  // with the first tool
  std::optional<ThinTissue> thin_;  // of linear elements
  std::vector<Trial> trials_;       // of them
  std::string why_no_press_;
};

}  // namespace palpate::sim
