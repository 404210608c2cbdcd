// Tools that turn, rub and grasp, watched and compared.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fmt/core.h>

#include "common/error.h"
#include "sim_server/mesh/shapes.h"
#include "sim_server/mesh/surface.h"
#include "sim_server/scene/scene.h"
#include "sim_server/solvers/equilibrium.h"
#include "tests/studies/robustness.h"
#include "tests/support/solids.h"

namespace palpate::studies {
namespace {

using namespace palpate::sim;

constexpr double kNothing = 1e-9;  // N, N m: less is no force, and no torque

/// Where the tools were at the instants within the step that ends at `t`; empty where one was lifted.
std::vector<std::vector<sim::PathPoint>> paths_to(const World& world, double t, double dt, int instants) {
  std::vector<std::vector<sim::PathPoint>> paths(world.hands(t).size());
  for (int k = 1; k < instants; ++k) {
    const std::vector<ToolInput> there = world.hands(t - dt + k * dt / instants);
    for (std::size_t tool = 0; tool < paths.size(); ++tool) {
      if (there[tool].pose) paths[tool].push_back({*there[tool].pose});
    }
  }
  return paths;
}

void see_step(const Simulation& simulation, std::span<const ToolInput> inputs,
              std::span<const ToolAnswer> answers, double t, Watched& watched) {
  Rendered rendered{t, {}, {}, {}, !simulation.balanced()};
  for (std::size_t k = 0; k < answers.size(); ++k) {
    const ToolAnswer& answer = answers[k];
    rendered.poses.push_back(inputs[k].pose.value_or(ToolPose{}));
    rendered.force.push_back(answer.force);
    rendered.torque.push_back(answer.torque);
    rendered.flagged = rendered.flagged || answer.flagged;
    watched.finite =
        watched.finite && answer.force.allFinite() && answer.torque.allFinite() && answer.tangent.allFinite();
    watched.max_newton = std::max(watched.max_newton, answer.force.norm());
    if (!answer.flagged) watched.wildest = std::max(watched.wildest, answer.force.norm());
  }
  for (const Vec3& x : simulation.positions()) watched.finite = watched.finite && x.allFinite();
  for (const Vec3& force : rendered.force) {
    if (!rendered.flagged) watched.max_trusted_newton = std::max(watched.max_trusted_newton, force.norm());
  }
  watched.flagged += rendered.flagged ? 1 : 0;
  watched.steps.push_back(std::move(rendered));
}

constexpr double kEdge = 0.005;  // m, of the mesh

}  // namespace

World block_of(const Setting& setting) {
  World world;
  world.file.young_modulus = setting.modulus;
  world.file.poisson_ratio = setting.nu;
  world.file.rate_hz = setting.rate_hz;
  world.file.fixed = fmt::format("[[fixed]]\nbox = [[-1, {0}, -1], [1, {0}, 1]]\n", -setting.thickness);
  const int layers = std::max(1, static_cast<int>(std::lround(setting.thickness / kEdge)));
  const auto side = test::lines(-0.015, 0.015, 6);
  world.mesh = sim::grid_block(side, test::lines(-setting.thickness, 0, layers), side);
  return world;
}

double Direction::seconds() const {
  double length = 0;
  for (std::size_t i = 1; i < places.size(); ++i) length += (places[i] - places[i - 1]).norm();
  return length / speed;
}

Vec3 Direction::at(double t) const {
  double remaining = t * speed;
  for (std::size_t i = 1; i < places.size(); ++i) {
    const Vec3 piece = places[i] - places[i - 1];
    if (remaining <= piece.norm()) return places[i - 1] + remaining / piece.norm() * piece;
    remaining -= piece.norm();
  }
  return places.back();
}

/// Down from 2 mm above the block, then along.
Direction press_and_draw(const Setting& setting, const Vec3& along) {
  const Vec3 above(0.001, kToolRadius + 0.002, 0.002), in(0.001, kToolRadius - setting.depth, 0.002);
  return {{above, in, in + along}, setting.speed};
}

World under_tool(const Setting& setting, const Direction& way) {
  World world = block_of(setting);
  world.seconds = way.seconds() + kRest;
  world.hands = [way](double t) { return std::vector<ToolInput>{at(way.at(t))}; };
  return world;
}

ToolInput at(const Vec3& p, const Quat& q) {
  return {.pose = ToolPose(p, q)};
}

Watched watch(const World& world, const Column& column) {
  Watched watched;
  with_simulation(world.file, world.mesh, column, [&](const Scene& scene, Simulation& simulation) {
    watched.locks = column.row->deforms() && scene.material && scene.material->locks();
    const std::vector<Vec3> began(simulation.positions().begin(), simulation.positions().end());
    const double dt = 1 / world.file.rate_hz;
    const int steps = static_cast<int>(std::lround(world.seconds / dt));
    for (int i = 1; i <= steps && watched.finite; ++i) {
      std::vector<ToolInput> inputs = world.hands(i * dt);
      const auto paths = paths_to(world, i * dt, dt, world.tells_path ? simulation.instants() : 1);
      for (std::size_t tool = 0; tool < inputs.size(); ++tool) inputs[tool].path = paths[tool];
      watched.held += watched.held + 1 == static_cast<std::size_t>(i) && inputs.front().pose ? 1 : 0;
      see_step(simulation, inputs, simulation.step(inputs, dt), i * dt, watched);
    }
    for (std::size_t v = 0; v < began.size(); ++v)
      watched.off = std::max(watched.off, (simulation.positions()[v] - began[v]).norm());
  });
  return watched;
}

Vectors force_of(const Rendered& rendered) {
  return {rendered.force.front()};
}

Vectors force_and_torque_of(const Rendered& rendered) {
  return {rendered.force.front(), rendered.torque.front()};
}

Expected as_in(Watched other, Published published, double from) {
  return [other = std::move(other), published = std::move(published),
          from](std::size_t i) -> std::optional<Vectors> {
    if (i >= other.steps.size() || other.steps[i].flagged || other.steps[i].t < from) return {};
    return published(other.steps[i]);
  };
}

Expected at_the_end(const World& world, Vectors right, double seconds) {
  const double from = (world.seconds - seconds) * world.file.rate_hz;
  return [right = std::move(right), from](std::size_t step) -> std::optional<Vectors> {
    if (static_cast<double>(step) < from) return {};
    return right;
  };
}

Verdict verdict_of(const Watched& watched, const std::string& reference) {
  if (!watched.finite)
    return {"exploded", "a force, torque, tangent or position that is not finite", {}, {}, reference};
  if (watched.flagged == 0) return {"stable", "", {}, watched.max_trusted_newton, reference};
  const std::string reason = fmt::format("{} of {} steps flagged", watched.flagged, watched.steps.size());
  return {"flagged", reason, {}, watched.max_trusted_newton, reference};
}

Verdict compare(const Watched& watched, const Published& published, const Expected& expected, double bound,
                const std::string& reference) {
  Verdict verdict = verdict_of(watched, reference);
  if (!watched.finite) return verdict;
  Vectors off, scale;
  std::vector<std::size_t> worst;
  for (std::size_t i = 0; i < watched.steps.size(); ++i) {
    const std::optional<Vectors> right = expected(i);
    if (!right) continue;
    const Vectors found = published(watched.steps[i]);
    off.resize(right->size(), Vec3::Zero());
    scale.resize(right->size(), Vec3(Vec3::Constant(kNothing)));
    worst.resize(right->size(), 0);
    for (std::size_t k = 0; k < right->size(); ++k) {
      if ((*right)[k].norm() > scale[k].norm()) scale[k] = (*right)[k];
      if (watched.steps[i].flagged || (found[k] - (*right)[k]).norm() <= off[k].norm()) continue;
      off[k] = found[k] - (*right)[k];
      worst[k] = i;
    }
  }
  for (std::size_t k = 0; k < off.size(); ++k) {
    const double error = off[k].norm() / scale[k].norm();
    verdict.error_percent = std::max(verdict.error_percent.value_or(0), 100 * error);
    if (error <= bound) continue;
    verdict.outcome = "wrong";
    verdict.reason =
        fmt::format("{} off by {:.2g} % of the largest, {:.3g}, at {:.3f} s, and not flagged",
                    k == 0 ? "force" : "torque", 100 * error, scale[k].norm(), watched.steps[worst[k]].t);
    return verdict;
  }
  return verdict;
}

Vectors reactions(const World& world, const Column& column, const std::vector<Gripped>& grips) {
  Vectors rendered(grips.size(), Vec3::Zero());
  with_simulation(world.file, world.mesh, column, [&](const Scene& scene, Simulation& simulation) {
    const Solid solid(simulation.mesh(), *scene.material);
    StaticLoad load{.held = std::vector<HeldAxes>(solid.rest().size(), 0),
                    .moved = std::vector<Vec3>(solid.rest().size(), Vec3::Zero())};
    for (const int node : fixed_vertices(scene, simulation.mesh())) load.held[node] = kAllAxes;
    std::vector<std::pair<int, std::size_t>> gripped;
    for (const int node : simulation.surface().vertices) {
      for (std::size_t k = 0; k < grips.size(); ++k) {
        if (load.held[node] != 0 || (solid.rest()[node] - grips[k].place).norm() > grips[k].reach) continue;
        load.held[node] = kAllAxes;
        load.moved[node] = grips[k].moved;
        gripped.emplace_back(node, k);
      }
    }
    const Equilibrium rest = find_equilibrium(solid, load, "study");
    std::vector<Vec3> force(solid.rest().size());
    solid.forces(rest.x, force);
    for (const auto& [node, k] : gripped) rendered[k] -= force[node];
  });
  return rendered;
}

Work work_of(const Watched& watched) {
  Work work;
  for (std::size_t i = 1; i < watched.steps.size(); ++i) {
    const Rendered &from = watched.steps[i - 1], &to = watched.steps[i];
    for (std::size_t k = 0; k < to.poses.size(); ++k) {
      const Eigen::AngleAxisd turn(to.poses[k].q_W * from.poses[k].q_W.conjugate());
      const double done = 0.5 * (from.force[k] + to.force[k]).dot(to.poses[k].p_W - from.poses[k].p_W) +
                          0.5 * turn.angle() * (from.torque[k] + to.torque[k]).dot(turn.axis());
      work.sum += done;
      work.size += std::abs(done);
    }
  }
  return work;
}

void add_rows(std::vector<Case>& rows, const std::string& name, const std::string& what, Judge judge,
              const std::vector<Setting>& settings, bool quick) {
  for (const Setting& setting : settings) {
    rows.push_back(world_row(name + setting.name, what + setting.what, quick && &setting == &settings.front(),
                             [=](const Column& column) { return judge(setting, column); }));
  }
}

Case world_row(const std::string& name, const std::string& what, bool quick,
               std::function<Verdict(const Column& column)> judge) {
  return {name, what, quick, [judge = std::move(judge)](const Case&, const Column& column, bool) -> Verdict {
            try {
              return judge(column);
            } catch (const Error& e) {
              return {"refused", e.what(), {}, {}, ""};
            }
          }};
}

}  // namespace palpate::studies
