#include "sim_server/contact/grip.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "common/error.h"

namespace palpate::sim {
namespace {

constexpr double kReach = 1.25;    // of the tool radius: tissue that touches, and a little around it
constexpr int kMaxVertices = 128;  // the factor of their compliance has 384 rows: 1.2 MB

std::vector<int> corners_of(std::span<const Triangle> triangles) {
  std::vector<int> all;
  for (const Triangle& t : triangles) all.insert(all.end(), t.begin(), t.end());
  std::ranges::sort(all);
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

/// The rotation by the least angle that takes one unit vector to another; none to its opposite.
Quat least_turn(const Vec3& from, const Vec3& to) {
  const double w = 1 + from.dot(to);
  const Vec3 v = from.cross(to);
  return w < 1e-9 ? Quat::Identity() : Quat(w, v.x(), v.y(), v.z()).normalized();
}

}  // namespace

Grip::Grip(const ToolSettings& tool, std::span<const Vec3> rest, std::span<const Triangle> touchable,
           int max_nodes)
    : buttons_(tool.grasp_buttons),
      reach_(kReach * tool.shape.radius),
      max_nodes_(static_cast<std::size_t>(std::min(max_nodes, kMaxVertices))),
      touchable_(corners_of(touchable)) {
  vertices_.reserve(max_nodes_);
  offsets_.reserve(max_nodes_);
  patch_.reserve(static_cast<int>(max_nodes_), 1);
  const auto most = 3 * static_cast<Eigen::Index>(max_nodes_);
  for (BoundedMatrix* const matrix : {&compliance_, &factor_}) {
    matrix->reserve(most, most);
    matrix->shape(0, 0);
  }
  misfit_.resize(3 * static_cast<Eigen::Index>(max_nodes_));
  spread_.resize(3 * static_cast<Eigen::Index>(max_nodes_), 3);
  stiffness_.resize(max_nodes_);
  if (tool.shape.trocar) pivot_ = tool.shape.trocar->pivot_W;
  if (!tool.grasp_place) return;
  close(*tool.grasp_place, rest);
  closed_at_.reset();  // by the first pose
  if (!holds()) {
    fail("{}: no vertex of the surface that the tool may touch lies within {:g} mm of `grasp_place`",
         tool.grasp_where, 1e3 * reach_);
  }
}

void Grip::change_surface(const SurfaceChange& change, std::span<const Triangle> touchable) {
  touchable_ = corners_of(touchable);
  std::vector<std::pair<int, Vec3>> copies;
  for (const auto& [copy, origin] : change.origins()) {
    const auto held = std::ranges::find(vertices_, origin);
    if (held != vertices_.end() && change.on_surface(copy))
      copies.emplace_back(copy, offsets_[static_cast<std::size_t>(held - vertices_.begin())]);
  }
  std::size_t stored = 0;
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    if (!change.on_surface(vertices_[i])) continue;
    vertices_[stored] = vertices_[i];
    offsets_[stored++] = offsets_[i];
  }
  vertices_.resize(stored);
  offsets_.resize(stored);
  for (const auto& [copy, offset] : copies) hold(copy, offset);
}

void Grip::close(const ToolPose& pose, std::span<const Vec3> positions) noexcept {
  closed_ = true;
  closed_at_ = pose;
  for (const int vertex : touchable_) {
    const Vec3 offset = positions[vertex] - pose.p_W;
    if (offset.norm() <= reach_) hold(vertex, offset);
  }
}

/// Where there is no room for one more, the nearest stay, in their order.
void Grip::hold(int vertex, const Vec3& offset) noexcept {
  if (vertices_.size() == max_nodes_) {
    const auto furthest = std::ranges::max_element(offsets_, {}, &Vec3::norm) - offsets_.begin();
    if (!(offset.norm() < offsets_[static_cast<std::size_t>(furthest)].norm())) return;
    vertices_.erase(vertices_.begin() + furthest);
    offsets_.erase(offsets_.begin() + furthest);
  }
  vertices_.push_back(vertex);
  offsets_.push_back(offset);
}

void Grip::open() noexcept {
  if (buttons_ == 0) return;
  closed_ = false;
  vertices_.clear();
  offsets_.clear();
}

Vec3 Grip::offset(std::size_t held, const ToolPose& pose) const {
  const Quat turn = turned(pose);
  return turn.coeffs() == Quat::Identity().coeffs() ? offsets_[held] : Vec3(turn * offsets_[held]);
}

/// Returns what the tool has turned by since the jaws closed.
Quat Grip::turned(const ToolPose& pose) const {
  if (!turns_ || !closed_at_) return Quat::Identity();
  if (pivot_) return least_turn(axis(*closed_at_), axis(pose));
  const Quat& from = closed_at_->q_W;
  return from.coeffs() == pose.q_W.coeffs() ? Quat::Identity() : Quat(pose.q_W * from.conjugate());
}

/// Column k: the turn (rad) per motion along axis k (m), of a shaft that pivots; zero of other tools. With a
/// its axis and a0 that at which the jaws closed, the least turn goes on by a x da - a (a0 x a) . da / (1 +
/// a0 . a).
Mat3 Grip::turn_of_motion(const ToolPose& pose) const {
  if (!pivot_ || !turns_ || !closed_at_) return Mat3::Zero();
  const Vec3 a = axis(pose), a0 = axis(*closed_at_), roll = -a0.cross(a) / (1 + a0.dot(a));
  Mat3 turn;
  for (int k = 0; k < 3; ++k) turn.col(k) = -(a.cross(Vec3::Unit(k)) + roll[k] * a);
  return turn / std::max((*pivot_ - pose.p_W).norm(), reach_);  // bounded where the jaws are in the trocar
}

/// Returns how far a held vertex goes per motion of the tool, that turns so.
Mat3 Grip::offset_of_motion(std::size_t held, const ToolPose& pose, const Mat3& turn) const {
  const Vec3 arm = offset(held, pose);
  Mat3 moved = Mat3::Identity();
  for (int k = 0; k < 3; ++k) moved.col(k) += turn.col(k).cross(arm);
  return moved;
}

/// Finds what is missing to the place of each vertex, into `misfit_`; returns the largest component, m.
double Grip::misfit(const ToolPose& pose, const ToolTissue& tissue, std::span<const VertexLoad> own) {
  const Vec3 tip = pose.p_W - patch_.tool_compliance * sum_of(own);
  double largest = 0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    const Vec3 missing =
        tip + offset(i, pose) - tissue.positions()[vertices_[i]] - contact_compliance_ * own[i].force;
    misfit_.segment<3>(3 * static_cast<Eigen::Index>(i)) = missing;
    largest = std::max(largest, missing.cwiseAbs().maxCoeff());
  }
  return largest;
}

/// The compliance under the loads of now, as its Cholesky factor: that of before, where it is the same.
bool Grip::factor(const ToolTissue& tissue) {
  tissue.model().compliance(vertices_, patch_);
  const auto m = static_cast<Eigen::Index>(vertices_.size());
  auto system = patch_.compliance.topLeftCorner(3 * m, 3 * m);
  for (Eigen::Index j = 0; j < m; ++j) {
    for (Eigen::Index i = 0; i < m; ++i)
      system.block<3, 3>(3 * i, 3 * j).diagonal().array() += patch_.tool_compliance;
  }
  contact_compliance_ = ContactSolver::contact_compliance(patch_, static_cast<int>(m));
  system.diagonal().array() += contact_compliance_;
  if (compliance_.rows() == 3 * m && compliance_ == system) return factored_;
  compliance_.shape(3 * m, 3 * m);
  factor_.shape(3 * m, 3 * m);
  compliance_ = system;
  factor_ = system;
  Eigen::Ref<Eigen::MatrixXd> in_place(factor_);
  factored_ = Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(in_place).info() == Eigen::Success;
  return factored_;
}

/// Takes the compliance of now: the stiffness of each vertex, where that is by itself, or the factor of all.
bool Grip::take_compliance(const ToolTissue& tissue) {
  const auto each = std::span(stiffness_).first(vertices_.size());
  const ComplianceSource* const source = tissue.traits().columns;
  alone_ = source != nullptr && source->each_alone(vertices_, each);
  if (!alone_) return factor(tissue);
  double sum = 0;
  for (const Mat3& compliance : each) sum += compliance.trace();
  patch_.tool_compliance = 0;
  contact_compliance_ = ContactSolver::contact_compliance(sum / (3 * static_cast<double>(each.size())));
  for (Mat3& one : each) one = (one + contact_compliance_ * Mat3::Identity()).inverse().eval();
  return true;
}

/// Turns what is missing (m) into the loads that bring it, N.
void Grip::solve(Eigen::Ref<Eigen::VectorXd> misfit) const noexcept {
  for (std::size_t i = 0; alone_ && i < vertices_.size(); ++i) {
    auto one = misfit.segment<3>(3 * static_cast<Eigen::Index>(i));
    one = (stiffness_[i] * one).eval();
  }
  if (alone_) return;
  const auto lower = factor_.triangularView<Eigen::Lower>();
  lower.solveInPlace(misfit);
  lower.adjoint().solveInPlace(misfit);
}

Mat3 Grip::tangent(const ToolPose& pose) noexcept {
  const std::size_t held = vertices_.size();
  const Mat3 turn = turn_of_motion(pose);
  Mat3 sum = Mat3::Zero();
  for (std::size_t i = 0; alone_ && i < held; ++i) {
    const Mat3 moved = offset_of_motion(i, pose, turn);
    sum -= moved.transpose() * stiffness_[i] * moved;
  }
  if (alone_) return sum;
  auto spread = spread_.topRows(3 * static_cast<Eigen::Index>(held));  // L^-1 J
  for (std::size_t i = 0; i < held; ++i)
    spread.middleRows<3>(3 * static_cast<Eigen::Index>(i)) = offset_of_motion(i, pose, turn);
  factor_.triangularView<Eigen::Lower>().solveInPlace(spread);
  return -spread.transpose() * spread;
}

Grip::Pull Grip::pull(const ToolPose& pose, ToolTissue tissue) {
  turns_ = tissue.traits().turns;
  if (!closed_at_) closed_at_ = pose;
  const std::size_t held = vertices_.size();
  const auto size = 3 * static_cast<Eigen::Index>(held);
  const std::span<VertexLoad> own = tissue.loads_on(vertices_);
  Pull pull{.vertices = static_cast<int>(held)};
  for (bool settled = false; !settled; ++pull.rounds) {
    tissue.apply_loads();
    settled = misfit(pose, tissue, own) <= kFits * reach_;
    pull.converged = take_compliance(tissue) && (settled || pull.rounds < kMaxRounds);
    if (settled || !pull.converged) break;
    auto change = misfit_.head(size);
    solve(change);
    for (std::size_t i = 0; i < held; ++i)
      own[i].force += change.segment<3>(3 * static_cast<Eigen::Index>(i));
  }
  for (std::size_t i = 0; i < held; ++i) {
    pull.force -= own[i].force;
    if (turns_) pull.torque -= offset(i, pose).cross(own[i].force);
  }
  if (pivot_) {  // at the tip, by the work; what else turns the shaft, the wall bears
    pull.force += turn_of_motion(pose).transpose() * pull.torque;
    pull.torque.setZero();
  }
  if (pull.converged) pull.tangent = tangent(pose);
  return pull;
}

std::size_t Grip::bytes() const {
  return patch_.compliance.bytes() + compliance_.bytes() + factor_.bytes() + stiffness_.size() * sizeof(Mat3);
}

}  // namespace palpate::sim
