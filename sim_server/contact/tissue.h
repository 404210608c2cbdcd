#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim_server/tissue/deformation_model.h"

namespace palpate::sim {

class ToolTissue;
struct SurfaceChange;

/// The tissue as all tools share it, with the loads of each. Positions are those of the surface vertices, m,
/// world. Only set-up allocates; what the model throws passes through. One thread.
class Tissue {
 public:
  std::unique_ptr<DeformationModel> model;
  ModelTraits traits;                ///< of the model
  std::span<const Vec3> free;        ///< in this step, without any contact
  std::span<const Vec3> velocities;  ///< of that, m/s; empty: it rests
  std::span<const Vec3> carried;     ///< as its supports alone have moved it; empty: they rest
  std::span<const Vec3> positions;   ///< now, under the loads of all tools
  std::vector<Vec3> before;          ///< at the end of the last step; empty where no tool has friction

  /// Takes over the free shape of a new instant or linearisation.
  void set_free(const FreeMotion& motion) noexcept;

  /// A step begins: any vertex may have moved since a tool last looked for contact.
  void start_step() noexcept;

  /// Its model goes on as another: no vertex has moved in that.
  void note_same_place() noexcept;

  /// Set-up: makes room for tools of these radii (m) that load so many vertices each; the surface at rest is
  /// `free`.
  void reserve(std::span<const int> most_loads, std::span<const double> radii);

  /// Returns the tissue as this tool meets it now. Two `apply` of the model; none while the others load
  /// nothing.
  ToolTissue touched_by(std::size_t tool);
  /// The loads that this tool puts on it by now.
  std::span<const VertexLoad> loads_of(std::size_t tool) const noexcept { return tools_[tool].own(); }
  /// Returns the memory that this tool alone takes, bytes.
  std::size_t bytes_of(std::size_t tool) const { return tools_[tool].pushed.size() * sizeof(Vec3); }
  /// A tool that is lifted has no loads, and knows of no other's.
  void separate(std::size_t tool) noexcept;
  /// The tool went along with the organ by `motion` (m): so did what it last met.
  void carry(std::size_t tool, const Vec3& motion) noexcept { tools_[tool].carried += motion; }
  /// Lets the loads of all tools follow a change of the surface (`SurfaceChange::apply_to`). Allocates.
  void change_surface(const SurfaceChange& change);
  /// Returns the tissue as this tool met it last: what the others have put on it since is not looked at.
  ToolTissue known_to(std::size_t tool);
  /// Replaces the loads of one tool; the tissue follows at `apply_all_loads`.
  void replace_loads(std::size_t tool, std::span<const VertexLoad> loads);
  /// The tissue goes where the loads of all tools press it. One `apply` of the model.
  void apply_all_loads();
  /// `positions`, under the loads of now, or where no tool has any.
  void apply_loads(std::size_t tool) { positions = model->apply(tools_[tool].loads); }
  void press_by_none() { positions = model->apply({}); }

  /// State of the tissue beside its model.
  struct State;
  State save() const;
  /// Takes over a state, of a model that was restored with it and is at `motion`.
  void restore(const State& state, const FreeMotion& motion);

 private:
  friend class ToolTissue;
  struct ToolLoads {
    std::vector<VertexLoad> loads;  // of the other tools, then its own
    std::size_t others = 0;         // how many of them are the others'
    std::span<const Vec3> free;     // the tissue's, or `pushed`
    std::vector<Vec3> pushed;       // free under the loads of the other tools; empty where there are none
    std::uint64_t pushed_in = 0;    // the motion in which that was
    double radius = 0;              // m
    std::vector<int> touched;       // vertices that mattered when its contact was last solved
    bool touched_any = true;        // any may have
    double went = 0;                // how far others have pushed any since then, in all, m
    std::vector<Vec3> solved;       // positions when its contact was last solved
    Vec3 carried = Vec3::Zero();    // how far it and the organ have gone since, m
    std::vector<Vec3> shift;        // how far the surface has gone since then besides, m
    double remaining = 0;           // the share of `shift` that is still to come
    bool shift_of_moved = false;    // the model knows only what `moved_` says
    std::uint64_t solved_in = 0;    // the motion in which that was
    std::uint64_t looked_in = 0;    // that in which it last looked for contact, at `positions`; 0: elsewhere
    std::vector<Vec3> positions_at, free_at;  // of the surface, at that
    std::span<const VertexLoad> own() const { return std::span(loads).subspan(others); }
  };
  bool touches(std::size_t tool);
  void take_loads_of_others(ToolLoads& mine);
  void put_on_way(ToolLoads& mine);
  bool push(ToolLoads& tool);
  std::span<const int> moved_since(const ToolLoads& tool) const noexcept;
  static void note_shift(ToolLoads& tool, std::span<const Vec3> positions, std::size_t vertex) noexcept;

  std::vector<ToolLoads> tools_;
  const std::vector<int>* moved_ = nullptr;  // by the last motion; null: any may have
  std::uint64_t motions_ = 1;                // so far
};

struct Tissue::State {
  std::vector<Vec3> before;
  std::vector<ToolLoads> tools;
  bool knows_moved = false;
  std::uint64_t motions = 1;
};

/// The tissue as one tool meets it: free of that tool, under the loads that the others put on it when this
/// was made (`Tissue::touched_by`), which are held.
class ToolTissue {
 public:
  const DeformationModel& model() const { return *tissue_.model; }
  const ModelTraits& traits() const { return tissue_.traits; }
  std::span<const Vec3> free() const;
  /// True if that has moved since this tool last met it: the vertices that mattered to its contact by more
  /// than rounding, or others so far that they may matter by now.
  bool moved() const { return moved_; }
  std::span<const Vec3> positions() const;
  std::span<const Vec3> before() const { return tissue_.before; }

  std::span<const VertexLoad> loads() const { return tissue_.loads_of(tool_); }
  /// The vertices that may have moved since this tool last looked for contact, which it does now; none: any.
  std::span<const int> moved_since_search() noexcept;
  /// Replaces the loads of this tool; the tissue follows at `apply_loads`.
  void set_loads(std::span<const VertexLoad> loads);
  /// The loads of this tool on `vertices`, to be changed in place: what is there where they are on these by
  /// now, else zeros.
  std::span<VertexLoad> loads_on(std::span<const int> vertices);
  void add_load(const VertexLoad& load) { tissue_.tools_[tool_].loads.push_back(load); }
  void drop_loads() { set_loads({}); }
  /// The tissue goes where all loads press it.
  void apply_loads();

  /// Returns how far (m) the surface has moved since the contact of this tool was last solved, where it may
  /// have come within `reach` (m) of the tool's axis from `p` to `q`: by a step of a tissue in motion, a new
  /// linearisation or other tools. Contact then meets that motion in parts. O(vertices).
  double surface_motion(const Vec3& p, const Vec3& q, double reach);
  /// Returns how much of this motion of a vertex is still to come, m.
  Vec3 still_to_come(int vertex) const noexcept;
  /// Puts the surface where that share of this motion is still to come, from 1 to 0. Of its answers,
  /// `positions` and `free` are there.
  void set_remaining_fraction(double remaining);
  /// The contact of this tool is solved with the surface as it is, of which these vertices matter to it, at
  /// most as many as it loads.
  void mark_solved(std::span<const int> touched) noexcept;
  /// Marks contact as solved, where any vertex may matter.
  void mark_solved() noexcept;
  /// Removes the loads of this tool, if it has any.
  void release();

 private:
  friend class Tissue;
  ToolTissue(Tissue& tissue, std::size_t tool, bool moved) : tissue_(tissue), tool_(tool), moved_(moved) {}

  Tissue& tissue_;
  std::size_t tool_;
  bool moved_;
};

}  // namespace palpate::sim
