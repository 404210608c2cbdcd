#include "sim_server/simulation.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/error.h"
#include "common/hash.h"
#include "common/text.h"
#include "sim_server/mesh/gmsh_io.h"

namespace palpate::sim {
namespace {

constexpr double kStride = 0.5;  // of the tool radius: how far the tool goes between two contact solves
constexpr double kGather = 2.0;  // of the tool radius: how far from the tip the patch extends
constexpr double kMaxStrides = 256;
constexpr double kEscape = 3.0;  // of the tool radius: how far outside the organ at rest contact may go on
constexpr int kMaxIterations =
    400;  // contact linearisations a step may use before it answers from where it got to
constexpr double kFarthest = 1e3;  // m

/// Surface vertices of the triangles that come near enough to the reach box for the tool to touch them there.
std::vector<Triangle> touchable_triangles(const Surface& surface, const TetMesh& mesh,
                                          const ToolSettings& tool) {
  if (!tool.reach) return surface.triangles;
  std::vector<Triangle> touchable;
  for (const Triangle& t : surface.triangles) {
    Vec3 min = mesh.vertices[surface.vertices[t[0]]], max = min;
    for (const int corner : t) {
      min = min.cwiseMin(mesh.vertices[surface.vertices[corner]]);
      max = max.cwiseMax(mesh.vertices[surface.vertices[corner]]);
    }
    if ((max.array() >= tool.reach->min.array()).all() && (min.array() <= tool.reach->max.array()).all()) {
      touchable.push_back(t);
    }
  }
  return touchable;
}

std::vector<int> vertices_of(const std::vector<Triangle>& triangles) {
  std::vector<int> vertices;
  for (const Triangle& t : triangles) vertices.insert(vertices.end(), t.begin(), t.end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

/// `read_mesh`, told to `progress`.
TetMesh read_mesh_of(const Scene& scene, const Progress& progress) {
  progress("reading the mesh", 0);
  return read_mesh(scene.mesh_file);
}

}  // namespace

std::vector<int> reachable_vertices(const Surface& surface, const TetMesh& mesh, const ToolSettings& tool) {
  return vertices_of(touchable_triangles(surface, mesh, tool));
}

Simulation::Simulation(const Scene& scene, const Progress& progress)
    : Simulation(scene, read_mesh_of(scene, progress), progress) {}

Simulation::Simulation(const Scene& scene, TetMesh mesh, const Progress& progress)
    : tool_(scene.tool.shape), mesh_(std::move(mesh)) {
  progress("extracting the surface", 0);
  surface_ = boundary_surface(mesh_);
  std::vector<Triangle> touchable = touchable_triangles(surface_, mesh_, scene.tool);
  if (touchable.empty()) fail("{}: no triangle of the surface lies in the tool's `reach` box", scene.source);
  const std::vector<int> reachable = vertices_of(touchable), fixed = fixed_vertices(scene, mesh_);
  model_ =
      find_row(deformation_models(), scene.deformation.model, "deformation model", scene.deformation.where)
          .make({scene, mesh_, surface_, fixed, reachable, progress});
  progress("preparing contact", 0);
  free_ = positions_ = model_->free_motion(0);
  finder_ = std::make_unique<ContactFinder>(positions_, surface_.triangles, std::move(touchable),
                                            kGather * tool_.radius);
  solver_ = std::make_unique<ContactSolver>(finder_->max_nodes(), finder_->max_triangles());
  patch_.reserve(finder_->max_nodes(), finder_->max_triangles());
  displacement_.resize(3 * (finder_->max_nodes() + 1));
  loads_.reserve(static_cast<std::size_t>(finder_->max_nodes()));
  progress("preparing contact", 1);
}

ToolForce Simulation::step(const Vec3& p_W, double dt) noexcept {
  free_ = model_->free_motion(dt);
  if (!p_W.allFinite() || p_W.cwiseAbs().maxCoeff() > kFarthest) return give_up();
  const double stride = kStride * tool_.radius;
  if (!placed_ || (p_W - place_).norm() > kMaxStrides * stride || escaped(p_W)) enter(p_W);
  const Vec3 way = p_W - place_, from = place_;
  const double strides = std::clamp(std::ceil(way.norm() / stride), 1.0, kMaxStrides);
  ContactForce contact;
  int iterations = 0;
  for (double i = 1; i <= strides && iterations < kMaxIterations; ++i) {
    place_ = i == strides ? p_W : Vec3(from + (i / strides) * way);
    contact = touch(place_);
    iterations += contact.iterations;
  }
  if (!contact.force.allFinite()) return give_up();
  const bool arrived = place_ == p_W;  // else the next step goes on from here
  last_ = {contact.force, solver_->tangent(patch_), contact.contacts, iterations,
           !contact.converged || !arrived};
  return last_;
}

/// No answer: the tool is taken away, and enters afresh with the next step.
ToolForce Simulation::give_up() noexcept {
  lift_tool();
  last_.flagged = true;
  return last_;
}

/// Whether a tool in contact has left the organ at rest so far behind that it only drags the surface along
/// with it: a linear tissue would let itself be wrapped around the tool and follow it anywhere.
bool Simulation::escaped(const Vec3& p_W) const noexcept {
  if (last_.contacts == 0) return false;
  return (finder_->nearest(free_, p_W) - p_W).norm() > kEscape * tool_.radius && !finder_->inside(free_, p_W);
}

void Simulation::lift_tool() noexcept {
  release();
  placed_ = false;
  last_ = {};
}

/// The tool appears at `p_W`. If that is inside the organ it is taken to have come in through the nearest
/// surface.
void Simulation::enter(const Vec3& p_W) noexcept {
  release();
  placed_ = true;
  place_ = p_W;
  if (!finder_->inside(positions_, p_W)) return;
  const Vec3 door = finder_->nearest(positions_, p_W);
  const Vec3 outward = (door - p_W).normalized();
  place_ = door + tool_.radius * (outward.allFinite() ? outward : Vec3(Vec3::UnitY()));
}

ContactForce Simulation::touch(const Vec3& p_W) noexcept {
  finder_->gather(positions_, free_, p_W + tip_offset_, kGather * tool_.radius, patch_);
  if (patch_.triangles.empty()) {
    release();
    return {};
  }
  const std::span<const int> vertices = finder_->vertices();
  model_->compliance(vertices, patch_);
  const int m = patch_.nodes();
  auto u = displacement_.head(3 * (m + 1));
  for (int i = 0; i < m; ++i) u.segment<3>(3 * i) = positions_[vertices[i]] - patch_.free[i];
  u.tail<3>() = tip_offset_;
  const ContactForce contact = solver_->solve(patch_, tool_, p_W, u);
  tip_offset_ = u.tail<3>();
  loads_.clear();
  const auto forces = solver_->node_forces();
  for (int i = 0; i < m; ++i) {
    if (!forces.segment<3>(3 * i).isZero(0)) loads_.push_back({vertices[i], forces.segment<3>(3 * i)});
  }
  positions_ = model_->apply(loads_);
  return contact;
}

void Simulation::release() noexcept {
  tip_offset_.setZero();
  if (!loads_.empty()) {
    loads_.clear();
    positions_ = model_->apply(loads_);
  }
}

std::vector<MemoryPart> Simulation::memory() const {
  std::vector<MemoryPart> parts = model_->memory();
  parts.push_back(
      {"mesh", mesh_.vertices.size() * sizeof(Vec3) + mesh_.tetrahedra.size() * sizeof(Tetrahedron)});
  parts.push_back(
      {"surface", surface_.vertices.size() * sizeof(int) + surface_.triangles.size() * sizeof(Triangle)});
  parts.push_back(
      {"contact", solver_->bytes() + static_cast<std::size_t>(patch_.compliance.size()) * sizeof(double)});
  return parts;
}

std::uint64_t Simulation::state_hash() const noexcept {
  Fnv1a hash;
  hash.add(positions_.data(), positions_.size_bytes());
  hash.add(last_.force);
  return hash.value();
}

}  // namespace palpate::sim
