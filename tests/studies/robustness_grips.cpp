// Rows of the robustness study: jaws that hold tissue, friction, and the work that tools give back. Held
// against equilibria found without any contact, Coulomb's cone and the first law.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <numbers>

#include "tests/studies/robustness.h"

namespace palpate::studies {
namespace {

using sim::ToolInput;

constexpr double kPenalty = 800;     // N/m, of models that do not deform
constexpr double kSwingsOut = 2;     // s, after all motion
constexpr double kGripReach = 1.25;  // of the radius of the jaws, as `configs/README.md` says

std::string jaws(double radius, const Vec3& place) {
  return tool(radius, fmt::format("grasp_place = [{}, {}, {}]", place[0], place[1], place[2]));
}

/// Jaws that hold the top at `places`, each moved by `moved`.
Verdict pulled(const Setting& setting, const Column& column, double radius, const Vectors& places,
               const Vectors& moved) {
  World world = block_of(setting);
  world.file.tools.clear();
  std::vector<Direction> ways;
  std::vector<Gripped> grips;
  Vectors right;
  world.seconds = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    world.file.tools.push_back(jaws(radius, places[k]));
    ways.push_back({{places[k], places[k] + moved[k]}, setting.speed});
    grips.push_back({places[k], kGripReach * radius, moved[k]});
    right.emplace_back(-kPenalty * moved[k]);
    world.seconds = std::max(world.seconds, ways.back().seconds() + kSwingsOut);
  }
  world.hands = [ways](double t) {
    std::vector<ToolInput> inputs;
    for (const Direction& way : ways) inputs.push_back(at(way.at(t)));
    return inputs;
  };
  const bool deforms = column.row->deforms();
  if (deforms) right = reactions(world, column, grips);
  const Watched watched = watch(world, column);
  return compare(
      watched, [](const Rendered& rendered) { return rendered.force; }, at_the_end(world, right), kSame,
      deforms ? "the equilibrium of the body, its gripped vertices displaced, without contact"
              : "closed form: stiffness x displacement");
}

Verdict grasp_pulled(const Setting& setting, const Column& column) {
  return pulled(setting, column, 0.01, {Vec3(0, 0.01, 0)}, {Vec3(0.0015, 0.003, -0.001)});
}

/// One organ that is not deformed cannot be in two places.
Verdict grasp_pulled_apart(const Setting& setting, const Column& column) {
  if (!column.row->deforms())
    return {"not_applicable", "an organ that goes as one cannot be pulled apart", {}, {}, ""};
  return pulled(setting, column, 0.007, {Vec3(-0.01, 0.007, 0), Vec3(0.01, 0.007, 0)},
                {Vec3(-0.001, 0.001, 0), Vec3(0.0015, 0.002, 0.001)});
}

/// Let go in the middle of the motion, which goes on.
Verdict grasp_let_go(const Setting& setting, const Column& column) {
  World world = block_of(setting);
  world.file.tools = {tool(0.01, "grasp_buttons = 1")};
  const double closed = 0.2;  // s
  const Direction way{{Vec3(0, 0.0095, 0), Vec3(0.001, 0.0125, 0), Vec3(0.002, 0.04, 0)}, setting.speed};
  const double open = closed + std::max(0.003 / setting.speed, 1.1 / setting.rate_hz);
  world.seconds = closed + way.seconds() + kSwingsOut;
  world.hands = [=](double t) {
    ToolInput input = at(way.at(std::max(0.0, t - closed)));
    input.buttons = t < open ? 1 : 0;
    return std::vector<ToolInput>{input};
  };
  const Watched watched = watch(world, column);
  Verdict verdict =
      compare(watched, force_of, at_the_end(world, {Vec3::Zero()}), kSame, "no force, and the shape at rest");
  if (verdict.outcome != "exploded") verdict.error_percent = 100 * watched.off / 0.003;
  if (watched.max_trusted_newton == 0) return {"wrong", "it never held anything", {}, {}, verdict.reference};
  if (verdict.outcome == "stable" && watched.off > 1e-3 * 0.003) {
    verdict.outcome = "wrong";
    verdict.reason = fmt::format("its surface stays up to {:.3g} mm off", 1e3 * watched.off);
  }
  return verdict;
}

/// A small ball presses one vertex down and draws it along, without slip.
Verdict friction_sticks(const Setting& setting, const Column& column) {
  constexpr double kSmall = 0.0003;
  const Vec3 moved(1e-4, -2e-4, 0), in(0, kSmall - 2e-4, 0);
  World world = block_of(setting);
  world.file.tools = {tool(kSmall, "friction = 2")};
  const Direction down{{Vec3(0, 0.0005, 0), in}, 0.001},
      along{{in, in + Vec3(moved[0], 0, 0)}, setting.speed};
  world.seconds = down.seconds() + along.seconds() + 2 * kSwingsOut;
  world.hands = [=](double t) {
    const double drawn = t - down.seconds() - kSwingsOut;
    return std::vector<ToolInput>{at(drawn > 0 ? along.at(drawn) : down.at(t))};
  };
  const Vectors right = column.row->deforms() ? reactions(world, column, {{Vec3::Zero(), 1e-4, moved}})
                                              : Vectors{-kPenalty * moved};
  return compare(watch(world, column), force_of, at_the_end(world, right), 0.01,
                 column.row->deforms() ? "the equilibrium of the body, that vertex displaced, without contact"
                                       : "closed form: stiffness x displacement");
}

/// A ball so large and so little deep that no normal of its contact is farther than `lean` from the vertical:
/// what slips has its force within as much of the cone.
Verdict friction_slips(const Setting& setting, const Column& column) {
  constexpr double kLarge = 0.05, kDepth = 1e-4;
  const double lean = std::acos(1 - kDepth / kLarge), cone = std::atan(setting.friction);
  World world = block_of(setting);
  world.file.tools = {tool(kLarge, fmt::format("friction = {}", setting.friction))};
  const Vec3 in(-0.006, kLarge - kDepth, 0.002);
  const Direction down{{in + Vec3(0, 0.001, 0), in}, 0.01},
      along{{in, in + Vec3(0.012, 0, 0)}, setting.speed};
  const double begins = down.seconds() + kRest, ends = begins + along.seconds();
  world.seconds = ends + kRest;
  world.hands = [=](double t) {
    return std::vector<ToolInput>{at(t > begins ? along.at(t - begins) : down.at(t))};
  };
  const Watched watched = watch(world, column);
  Verdict verdict = verdict_of(watched, "Coulomb's cone about all normals of the contact");
  if (!watched.finite) return verdict;
  for (const Rendered& rendered : watched.steps) {
    const Vec3& f = rendered.force.front();
    const bool slips = rendered.t > (begins + ends) / 2 && rendered.t <= ends;
    if (rendered.flagged || rendered.t < begins || f.norm() < 1e-9) continue;
    const double angle = std::atan2(std::hypot(f[0], f[2]), f[1]);
    if (slips)
      verdict.error_percent =
          std::max(verdict.error_percent.value_or(0), 100 * std::abs(std::tan(angle) / setting.friction - 1));
    if (angle <= cone + lean && !(slips && angle < cone - lean) && !(slips && f[0] > 0)) continue;
    verdict.outcome = "wrong";
    verdict.reason =
        fmt::format("at {:.3f} s across {:.3g} of what is along the normal, where {:.3g} to {:.3g} are right",
                    rendered.t, std::tan(angle), slips ? std::tan(cone - lean) : 0, std::tan(cone + lean));
    return verdict;
  }
  return verdict;
}

/// Once around and out again: no tool gives its hand more than it took, but for what the trapezoidal rule
/// leaves, and what swings at the end is the tissue's.
Verdict gives_nothing(World world, const Column& column) {
  world.file.rayleigh_mass = 10;
  const Watched watched = watch(world, column);
  Verdict verdict = verdict_of(watched, "no more work than was done, of all work to and fro");
  if (!watched.finite) return verdict;
  const Work work = work_of(watched);
  verdict.error_percent = 100 * std::max(0.0, work.sum) / work.size;
  if (watched.flagged == 0 && !(*verdict.error_percent < 1)) {
    verdict.outcome = "wrong";
    verdict.reason =
        fmt::format("it gives {:.3g} mJ, of {:.3g} mJ to and fro", 1e3 * work.sum, 1e3 * work.size);
  }
  return verdict;
}

std::vector<Vec3> around(const Vec3& above, const Vec3& in) {
  const Vec3 x(0.004, 0, 0), z(0, 0, 0.004);
  return {above, in, in + x, in + x + z, in + z, in, above};
}

Verdict work_of_friction(const Setting& setting, const Column& column) {
  World world = block_of(setting);
  const Direction way{around(Vec3(-0.001, 0.006, -0.002), Vec3(-0.001, kToolRadius - setting.depth, -0.002)),
                      setting.speed};
  world.seconds = way.seconds();
  world.file.tools = {tool(kToolRadius, fmt::format("friction = {}", setting.friction))};
  world.hands = [way](double t) { return std::vector<ToolInput>{at(way.at(t))}; };
  return gives_nothing(world, column);
}

Verdict work_of_capsule(const Setting& setting, const Column& column) {
  World world = block_of(setting);
  const Direction way{around(Vec3(-0.001, 0.006, -0.006), Vec3(-0.001, kToolRadius - setting.depth, -0.006)),
                      setting.speed};
  world.seconds = way.seconds();
  world.file.tools = {tool(kToolRadius, "shape = \"capsule\"\nlength = 0.012")};
  world.hands = [way](double t) {
    const double turn = 2 * std::numbers::pi * t / way.seconds();
    const Quat q = Quat(Eigen::AngleAxisd(0.5 * std::sin(turn), Vec3::UnitY())) *
                   Quat(Eigen::AngleAxisd(0.1 * std::sin(2 * turn), Vec3::UnitX()));
    return std::vector<ToolInput>{at(way.at(t), q)};
  };
  return gives_nothing(world, column);
}

Verdict work_of_trocar(const Setting& setting, const Column& column) {
  World world = block_of(setting);
  const Direction way{around(Vec3(-0.001, 0.008, -0.01), Vec3(-0.001, kToolRadius - setting.depth, -0.01)),
                      setting.speed};
  world.seconds = way.seconds();
  world.file.tools = {
      tool(kToolRadius, "shape = \"trocar\"\npivot = [0.001, 0.012, 0.05]\nshaft_radius = 0.003")};
  world.hands = [way](double t) { return std::vector<ToolInput>{at(way.at(t))}; };
  return gives_nothing(world, column);
}

Verdict work_of_grip(const Setting& setting, const Column& column) {
  World world = block_of(setting);
  const Vec3 place(0, 0.01, 0);
  const Direction way{around(place, place + Vec3(0, 0.003, 0)), setting.speed};
  world.seconds = way.seconds();
  world.file.tools = {jaws(0.01, place)};
  world.hands = [way](double t) { return std::vector<ToolInput>{at(way.at(t))}; };
  return gives_nothing(world, column);
}

}  // namespace

void add_grips(std::vector<Case>& rows) {
  const Setting hard{.name = "_E_1e9", .what = ", E 1 GPa", .modulus = 1e9};
  const Setting thin{.name = "_thin", .what = ", 3 mm thick", .thickness = 0.003, .depth = 0.001};
  const Setting quick{.name = "_1_m_s", .what = ", at 1 m/s", .speed = 1};
  add_rows(rows, "grasp_pulled", "jaws pull the top by 3.5 mm", grasp_pulled, {{}, hard, thin, quick}, true);
  add_rows(rows, "grasp_apart", "two pairs of jaws pull apart", grasp_pulled_apart, {{}, hard});
  add_rows(rows, "grasp_let_go", "jaws that open while they pull", grasp_let_go, {{}, quick});
  add_rows(rows, "friction_sticks", "a vertex pressed and drawn by less than the cone bears", friction_sticks,
           {{}, hard, quick});
  // Beyond mu = 0.5 what is drawn may wedge itself on thin or nearly incompressible tissue: it comes up
  // before the tool, and sticks.
  add_rows(
      rows, "friction_slips", "drawn by 12 mm", friction_slips,
      {{.name = "_0.5", .what = ", friction 0.5", .friction = 0.5},
       {.name = "_0.1", .what = ", friction 0.1, 3 mm thick", .thickness = 0.003, .friction = 0.1},
       {.name = "_2", .what = ", friction 2, at 1 m/s, 1 kHz", .rate_hz = 1000, .speed = 1, .friction = 2}},
      true);
  // So short are steps that the trapezoidal rule leaves less than 1 %.
  const Setting fine{.what = ", 1 kHz", .rate_hz = 1000};
  add_rows(rows, "work_friction", "once around with friction, and out", work_of_friction, {fine});
  add_rows(rows, "work_capsule", "the same with a capsule that turns", work_of_capsule, {fine}, true);
  add_rows(rows, "work_trocar", "the same with a shaft about its pivot", work_of_trocar, {fine});
  add_rows(rows, "work_grip", "the same with jaws", work_of_grip, {fine});
}

}  // namespace palpate::studies
