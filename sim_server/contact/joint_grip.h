#pragma once
#include <span>
#include <vector>

#include "sim_server/contact/tool_contact.h"

namespace palpate::sim {

/// Tissue in the jaws of several tools, all of it at once: what one lifts the others hold less of, so that
/// two instruments close to each other share a load, however stiff the tissue between them is against the
/// rest. With C the model's compliance at the vertices of all grips, c_t that of a tool and E_k the sum over
/// those of tool k, the loads f on the tissue hold
///   free + C f = E_k p_k + offsets - c_t E_k E_k^T f   for each k
/// (`Grip` is this for one tool). Newton's method: one round where the tissue is linear. A vertex that two
/// hold is borne by both alike. Only the constructor allocates; what the model throws passes through. One
/// thread.
class JointGrip {
 public:
  /// Makes room for what all of `tools` hold at most.
  explicit JointGrip(std::span<const ToolContact> tools);

  /// Replaces the loads of all tools that hold tissue by those with which they hold it where they are now,
  /// under the loads of the others as they are. Their forces are those of before: `ToolContact::settle` finds
  /// them. Nothing changes where fewer than two hold some. Where no balance is found, the loads are those of
  /// the last round.
  void settle(std::span<const ToolContact> tools, Tissue& tissue);

  std::size_t bytes() const { return patch_.compliance.bytes() + factor_.bytes(); }

 private:
  void gather(std::span<const ToolContact> tools, const Tissue& tissue);
  void put_loads(Tissue& tissue);
  double misfit(std::span<const ToolContact> tools, const Tissue& tissue);
  bool factor(const Tissue& tissue);

  /// A tool that holds tissue: which, and where its vertices begin among all.
  struct Holder {
    std::size_t tool;
    Eigen::Index first;
  };
  std::vector<Holder> holders_;
  std::vector<int> vertices_;
  std::vector<VertexLoad> loads_;
  ContactPatch patch_;
  BoundedMatrix factor_;
  double contact_compliance_ = 0;  // m/N, in series with each vertex
  Eigen::VectorXd misfit_;         // m
};

}  // namespace palpate::sim
