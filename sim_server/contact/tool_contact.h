#pragma once

#include "sim_server/contact/contact_finder.h"
#include "sim_server/contact/grip.h"
#include "sim_server/contact/surface_change.h"
#include "sim_server/contact/tissue.h"

namespace palpate::sim {

/// Force on a tool after one step.
struct ToolForce {
  Vec3 force = Vec3::Zero();   ///< N, world, on the tool at its tip: what the device renders
  Vec3 torque = Vec3::Zero();  ///< N m, world, on the tool about its tip; 0 for a shaft that pivots
  /// dF/dp, N/m, symmetric without friction; the loads of other tools held. Zero where nobody wants it.
  Mat3 tangent = Mat3::Zero();
  int contacts = 0;    ///< touching faces, edges and vertices; or vertices that it grasps
  int iterations = 0;  ///< contact linearisations, all sub-places together
  /// No settled answer: a wild position (then there is no force), contact that did not converge, several
  /// tools without a common equilibrium (then all stay, with their forces, where they were), tissue
  /// that closed over the tool, a motion too long for one step (then the force belongs to the place the tool
  /// got to), or an organ that ran away: some of its surface at no finite place, or, though held, three times
  /// its size from rest (then the force is half that of the step before), contact given up because the
  /// surface was dragged too far from its free place, or tissue that found no balance, or a model that threw
  /// (then the force is that of the step before).
  bool flagged = false;
};

/// The touchable surface nearest to a tool.
struct SurfacePlane {
  Vec3 normal_W = Vec3::Zero();  ///< towards the tool, unit
  double gap = 0;                ///< how far the tip can go against the normal, m; 0 where the tool touches
};

/// Departure of a tool's path between two poses from a straight line: how much further it would have come at
/// its velocity at the beginning, and at the end, m.
struct Bend {
  Vec3 begin = Vec3::Zero(), end = Vec3::Zero();
};

/// Tool and its contact with the tissue: its pose, its force, its loads on the surface. Only set-up
/// allocates; what the model throws passes through. One thread.
class ToolContact {
 public:
  /// `rest`: surface vertices at rest; `held`: those of them that are held to something, ascending.
  /// `cut`: that surface may change.
  ToolContact(const ToolSettings& tool, std::span<const Vec3> rest, const Surface& surface,
              std::vector<Triangle> touchable, std::span<const int> held, bool cut = false);

  /// Takes over the state of a copy of this tool, saved before.
  void restore_from(const ToolContact& saved) {
    *this = saved;
    filled_.clear();  // the patch refers to these vertices, and to the compliance of the model
  }

  /// Takes over a surface that was cut, of which it can touch these triangles. What it holds and presses
  /// stays so on both sides of a cut. Allocates.
  void change_surface(const SurfaceChange& change, std::vector<Triangle> touchable);

  /// Sets which of the device's buttons are pressed, also while the tool is lifted: the next `advance_to`
  /// grasps, or releases.
  void set_buttons(std::uint16_t buttons) noexcept {
    if (grip_) grip_->set_buttons(buttons);
  }
  /// Goes to `pose` on a straight line (with friction: as `path` says), turning evenly, in increments on
  /// which no point of its axis goes farther than half its radius, so that a fast tool does not jump through
  /// the surface; shorter ones with friction, which follows the path. Slip is measured from where the tissue
  /// really was: at the end of the last step, then of each increment (`slip_lead`).
  void advance_to(const ToolPose& pose, const Bend& path, ToolTissue tissue);
  /// The organ has moved under it: the tool goes along by `motion` (m), so that it stands on the surface as
  /// before.
  void carry(const Vec3& motion) noexcept {
    if (now_.placed) now_.place.p_W += motion;
    predictor_.from += motion;
  }
  /// Returns the velocity of the surface where the tool touches, by these loads (the mean by force), or else
  /// at the point nearest to `p_W`. `velocities`: of the surface vertices, m/s; empty: it rests.
  Vec3 surface_velocity(const Vec3& p_W, const Tissue& tissue, std::span<const Vec3> velocities,
                        std::span<const VertexLoad> loads) const noexcept;
  /// Solves its last increment again, on the surface as it is free by now.
  void settle(ToolTissue tissue);
  /// Finds the triangles near the tool where it is, of a surface at `positions` that would be at `free`
  /// without it. The compliance of the patch is not there; its nodes are `patch_vertices`.
  const ContactPatch& gather(std::span<const Vec3> positions, std::span<const Vec3> free) noexcept;
  std::span<const int> patch_vertices() const { return finder_.vertices(); }
  /// Opens or closes the jaws, as the buttons say: before its way in a step, and after it.
  void open_grip(ToolTissue tissue);
  void close_grip(ToolTissue tissue);
  /// Starts the way to `pose`, as `advance_to` does, in `increments`. Returns false if there is no such
  /// place: then the tool is taken away. Not of a tool that holds tissue.
  bool start_way(const ToolPose& pose, Bend path, ToolTissue tissue);
  /// Starts to solve the last increment again, on the surface as it is free by now.
  void start_settling(ToolTissue tissue);
  int increments() const { return way_.increments; }
  /// Goes to the end of this increment, from 1, of so many in all.
  void go_on(int increment, int of, ToolTissue tissue);
  /// Solves contact of this tool alone where it is now, and puts its loads on the tissue.
  ContactForce solve_contact(ToolTissue tissue);
  /// Takes over where the tip stands by a contact that was solved elsewhere, from the place, m.
  void set_tip_offset(const Vec3& offset) noexcept { now_.tip_offset = offset; }
  /// Notes the contact of an increment, whose loads are on the tissue, with the forces of its features, of
  /// which those of `index` are its own. Where the tissue has closed over the tool, it stops, and stands
  /// before the surface without a load.
  void note(const ContactForce& contact, std::span<const FeatureForce> features, int index,
            ToolTissue tissue);
  void note(const ContactForce& contact, ToolTissue tissue) {
    note(contact, solver_.feature_forces(), 0, tissue);
  }
  /// True if it goes no further in this step.
  bool has_stopped(const ToolTissue& tissue) const;
  /// Ends the way with this contact.
  void end_way(const ContactForce& contact, ToolTissue tissue);
  /// Remembers where it stands and what it feels, with its `loads`; `restore` takes it, and the tissue, back
  /// there, bit by bit.
  void keep(std::span<const VertexLoad> loads);
  void restore(ToolTissue tissue);
  /// Returns the force that the tool would have at `p_W` (m), with its present orientation. Leaves no trace,
  /// bit by bit.
  ToolForce probe(const Vec3& p_W, ToolTissue tissue);
  /// The surface nearest to a tool, all of it, with its tip at `p_W` outside the tissue, as it is now.
  /// O(vertices).
  SurfacePlane nearest(const Vec3& p_W, const Tissue& tissue) const noexcept;
  /// The touchable vertex nearest to `p_W`, as the surface is now. O(vertices).
  int nearest_vertex(const Vec3& p_W, const Tissue& tissue) const noexcept {
    return finder_.nearest_vertex(tissue.positions, p_W);
  }
  /// Returns how deep it is in tissue that its `reach` leaves out, m: it feels nothing of that. 0: not at
  /// all.
  double depth_outside_reach(std::span<const Vec3> positions) const noexcept;
  /// Returns the largest change of length of the surface's edges near it, by their length at rest: strain.
  double surface_strain(std::span<const Vec3> positions, std::span<const Vec3> rest) const noexcept;
  /// Returns the smallest area of the surface's faces near it, seen along their normals at rest, by their
  /// area at rest: 1 of tissue at rest, below 0 of a face that is turned over. `floating`: 1 for each vertex
  /// of a part that turns as one piece, whose faces are left out; empty: none does.
  double least_area(std::span<const Vec3> positions, std::span<const Vec3> rest,
                    std::span<const char> floating) const noexcept;
  /// Away from the tissue, on which it has no load any more: no force.
  void separate() noexcept;
  /// Adds the tangent to `force`. Of the last place where contact was solved: before another is asked for.
  void differentiate(ToolTissue tissue) noexcept;
  /// Adds that of tool `index` of a patch of these vertices, whose contact was solved elsewhere.
  void differentiate(ContactSolver& solver, const ContactPatch& patch, int index,
                     std::span<const int> vertices, const ToolTissue& tissue) noexcept;
  /// Sets how long (s) a tool holds its new place in tangents; 0: to the end of the step.
  void predict_tangent(double seconds) noexcept { tangent_time_ = seconds; }
  /// Says that `force` is not settled.
  void flag() noexcept { now_.force.flagged = true; }

  bool placed() const { return now_.placed; }
  /// True if it has tissue in its jaws.
  bool holds() const { return grip_ && grip_->holds(); }
  /// The vertices in its jaws, and from `place` to where each is held, m; of a tool that holds some.
  std::span<const int> held_vertices() const { return grip_->vertices(); }
  Vec3 held_offset(std::size_t held) const { return grip_->offset(held, now_.place); }
  int max_held() const { return grip_ ? grip_->max_vertices() : 0; }
  /// True if it releases tissue at the next `advance_to`.
  bool opens() const { return grip_ && grip_->opens(); }
  /// True if it takes hold of tissue at the end of its way in this step.
  bool closes() const { return grip_ && grip_->closes(); }
  /// True if this step has used up its contact linearisations.
  bool exhausted() const;
  const ToolForce& force() const { return now_.force; }
  const Vec3& place() const { return now_.place.p_W; }
  /// Where the tip is, less `place`, m.
  const Vec3& tip_offset() const { return now_.tip_offset; }
  /// Returns by which share of what tool and surface did in the increment before the slip of the one in hand
  /// is measured from ahead of its start; 0: from its start. With friction: then its direction is that at the
  /// end of the increment to second order, not only its mean over it (backward differences, Curtiss and
  /// Hirschfelder 1952, Proc. Natl. Acad. Sci. 38:235, of increments of any lengths). What sticks, or is at
  /// rest, is not ahead of itself.
  double slip_lead() const noexcept;
  /// Returns true if it has gone anywhere in this increment or in the one before; only with friction.
  bool has_way() const noexcept;
  /// Returns where the tip was when the increment in hand began, ahead by `lead`; only with friction.
  ToolPose slip_start(double lead) const noexcept;
  /// Returns how far a surface vertex is ahead of where it was then, m; 0 where that is not known.
  Vec3 surface_lead(int vertex, double lead) const noexcept;
  /// Returns how far a surface vertex, or the tip, goes in the increment in hand if things go on as in the
  /// one before, m; 0 where nothing is known, as without friction.
  Vec3 foreseen(int vertex) const noexcept;
  Vec3 foreseen_tip() const noexcept;
  /// Returns how far things may be from there, m.
  double uncertainty() const noexcept;
  /// Adds to the displacement `u` (3m, m) of a patch of these vertices what the way from where the tool was
  /// differentiated does, to first order. `work` (3m) is overwritten.
  void predict(std::span<const int> vertices, ContactPatch& patch, Eigen::Ref<Eigen::VectorXd> u,
               Eigen::Ref<Eigen::VectorXd> work) noexcept;
  /// Appends the forces of its features in the increment before, as those of tool `index`.
  void append_forces(int index, std::vector<FeatureForce>& forces) const;
  /// Returns where a surface vertex was then; without friction, of those at `now`.
  const Vec3& increment_start(int vertex, std::span<const Vec3> now) const {
    return increment_from_.empty() ? now[vertex] : increment_from_[vertex];
  }
  const ToolPose& pose() const { return now_.place; }
  double radius() const { return tool_.radius; }
  const Tool& shape() const { return tool_; }
  std::span<const Triangle> touchable() const { return finder_.touchable(); }
  bool has_friction() const { return tool_.friction > 0; }
  int max_nodes() const { return finder_.max_nodes(); }
  int max_triangles() const { return finder_.max_triangles(); }
  std::size_t bytes() const;

 private:
  /// Motion of tool and surface in an increment with friction.
  struct Travel {
    struct Moved {
      int vertex;
      Vec3 by;  // m
    };
    Vec3 way = Vec3::Zero(), offset = Vec3::Zero();  // m, of the place, and of the tip from it
    Quat turn = Quat::Identity();
    Vec3 carried = Vec3::Zero();  // m, of the tissue under its load
    std::vector<Moved> surface;   // near the tool, in contact; else none
  };

  std::vector<Triangle> left_of_patch(const SurfaceChange& change, std::span<const Triangle> touchable) const;
  static bool is_tame(const ToolPose& pose) noexcept;
  void move_to(const ToolPose& pose, ToolTissue tissue);
  void solve_grasp(const ToolPose& pose, ToolTissue tissue);
  void reject(ToolTissue tissue);
  bool escaped(const ToolPose& pose, const ToolTissue& tissue) const noexcept;
  void place_outside(const ToolPose& pose, ToolTissue tissue);
  void store_side(const ToolTissue& tissue) noexcept;
  bool recover_from_inside(ToolTissue tissue);
  void note_trend(const ContactForce& contact, std::span<const FeatureForce> features, int index,
                  const ToolTissue& tissue) noexcept;
  bool follows_trend() const noexcept;
  void set_tangent(const Mat3& tangent, const ToolTissue& tissue) noexcept;
  void start_increment(bool first, const ToolTissue& tissue);
  double share_of(const Travel& travel) const noexcept;
  static bool sticks(const Travel& travel) noexcept;
  Vec3 place_at_entry(const ToolPose& pose, const Vec3& inside, double fraction,
                      const Vec3& entry) const noexcept;
  double surface_motion(ToolTissue tissue) const;
  double increments_for(double motion, double surface) const noexcept;
  double increments_to(const ToolPose& pose) const noexcept;
  Vec3 path_offset(double fraction, const Vec3& motion) const noexcept;
  void take_compliance(const ToolTissue& tissue);
  void release(ToolTissue tissue);
  void set_force(const ContactForce& contact, int iterations, ToolTissue tissue);

  /// Share of the shaft next to the pivot that hardly moves with the tip.
  static constexpr double kNearPivot = 0.1;

  Tool tool_;
  ContactFinder finder_;
  ContactSolver solver_;
  ContactPatch patch_;
  double tangent_time_ = 0;       // s
  double max_drag_;               // m, outside its free organ
  std::vector<int> filled_;       // surface vertices whose compliance the patch holds
  std::optional<Grip> grip_;      // for a tool that grasps
  Eigen::VectorXd displacement_;  // of the patch nodes, then of the tip
  // Where the last increment began; only with friction: the tissue's `before`, or surface_was_, and the tip.
  std::span<const Vec3> increment_from_;
  std::vector<Vec3> surface_was_, nodes_were_;
  Vec3 offset_was_ = Vec3::Zero();
  ToolPose tip_was_;
  /// The way of the tool in a step.
  struct Way {
    ToolPose from, to;
    Vec3 motion = Vec3::Zero();  // m
    Bend bend;
    double surface = 0;  // how far the surface comes along, m; 0: not so far that this matters
    int increments = 1;
    double length = 0, pressed = 0;  // of an increment, and of those in contact, of the tool radius
    int iterations = 0;
    bool again = false;  // it stays, and its last increment is solved again
    bool lost = false, touched = false, stopped = false;
  };
  Way way_;
  /// Pose and force of the tool.
  struct State {
    ToolPose place;                  // of the last step
    Vec3 tip_offset = Vec3::Zero();  // where the tip is, minus `place`
    bool placed = false, arrived = false;
    // The surface vertex that bore most of it when contact was last settled; -1: it touched nothing. Should
    // the tool be inside later, it is taken back to that side.
    int side = -1;
    ToolForce force;
    Mat3 grasp_tangent = Mat3::Zero();  // N/m, to the end of the step
  };
  State now_, stored_;
  std::vector<VertexLoad> stored_loads_;
  Travel before_;  // in the increment before the one in hand
  /// The last increment with friction: the next looks from there.
  struct Trend {
    Travel travel;
    std::vector<FeatureForce> forces;
  };
  Trend trend_, stored_trend_;
  /// Foretells the loads at the next place, to first order: how those at the place that was differentiated
  /// last change with the tool's.
  struct Predictor {
    struct LoadChange {
      int vertex;
      Mat3 per_motion;  // N/m
    };
    std::vector<LoadChange> changes;  // none: nothing is predicted
    Vec3 from = Vec3::Zero();         // m
  };
  Predictor predictor_, stored_predictor_;
  Eigen::VectorXd predicted_;  // displacement of the patch nodes, m
};

}  // namespace palpate::sim
