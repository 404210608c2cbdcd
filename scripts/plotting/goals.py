#!/usr/bin/python3
"""Compare what a study measured with the goals that were set before it.

DIR holds summary.json of scripts/study extrapolation or stability. Prints a table, and
writes it beside that as goals.txt. Errors are a mean over the motions of a world, but the
worst of maxima, jumps and energies, and the least stable of hands, count. What a quick
study leaves out is "-", and it says of no goal that it is met: it has too few cases.

Exit status: 0 written, whether the goals are met or not; 2 the folder cannot be used.
"""

import argparse
import json
import statistics
import sys
from pathlib import Path
from typing import NamedTuple

from pictures import quick_note

ERRORS = ("mean_percent", "p99_percent", "max_percent")
MEAN, ENERGY, PAPER = ("mean_percent",), ("energy_percent",), ("paper_mean_percent",)
COMBINE = {"max_percent": max, "jump_percent": max, "energy_percent": max, "stable_to_n_m": min,
           "stable_percent": min, "ns_per_tick": statistics.median,
           "ns_per_tick_p99": statistics.median}


class Goal(NamedTuple):
    where: str
    law: str
    what: str
    rows: dict            # {column: value} of those that count
    keys: tuple
    most: tuple = ()      # of each key
    least: tuple = ()     # likewise
    of: dict = {}         # with columns changed to these: a share of that


TISSUE = {"reference": "truth", "rate_hz": 33.3, "blended": False}
BLOCK = {**TISSUE, "world": "block", "speed_m_s": 0.017, "delay_ms": 35}
GRASP = {**BLOCK, "world": "grasp", "reference": "paper", "delay_ms": 0}
FAST = {**BLOCK, "speed_m_s": 0.05}
LOOP = {**BLOCK, "speed_m_s": 0.02}
BLENDED = {**BLOCK, "blended": True}
POSITION = {"method": "linear_position", "blended": False}
HAND = {"rate_hz": 30, "delay_ms": 38, "passivity": False}
WALL = {**HAND, "world": "linear", "operator": "typical"}
SOLVES, TWO, CHOOSES = "local_contact", "two_tangents", "best_recent"
OTHERS = {"method": "the best of the others"}
WORLDS = ("block", "stiff", "friction", "moving", "grasp", "liver", "liver_tensor_mass", "liver_reduced",
          "liver_implicit")


SWINGING = (("liver_tensor_mass", (1, 4, 10), (2, 6, 15)), ("liver_reduced", (1, 4, 10), (2, 6, 15)),
            ("liver_implicit", (2, 6, 15), (4, 10, 25)), ("implicit_linear", (1, 4, 10), (2, 6, 15)),
            ("implicit_neo_hookean", (2, 6, 15), (4, 10, 25)), ("implicit_prony", (1, 4, 10), (2, 6, 15)),
            ("two_tools", (1, 4, 10), (2, 6, 15)))  # 35 ms, 80 ms


def in_world(name):
    return {**BLOCK, "world": name}


def blended(law):
    return (
        Goal("35 ms, blended", law, "mean, of unblended", BLENDED, MEAN, (1.5,), of={"blended": False}),
        Goal("35 ms, blended", law, "largest jump, % of peak", BLENDED, ("jump_percent",), (5,)),
        Goal("35 ms, blended", law, "above 30 Hz, of linear_position", BLENDED, ("rough_percent",), (0.2,),
             of=POSITION))


EXTRAPOLATION = (
    *(Goal("grasp, no delay, line", law, "average %", GRASP, PAPER, (1.35 * paper,), (0.65 * paper,))
      for law, paper in (("constant", 1.1), ("linear_time", 0.3), ("linear_position", 0.1))),
    Goal("grasp, no delay, line", "learned_stiffness", "average %", GRASP, PAPER, (0.03,)),
    Goal("grasp, no delay, line", "tangent", "average %", GRASP, PAPER, (0.015,)),
    Goal("35 ms", "learned_stiffness", "mean %", BLOCK, MEAN, (3,)),
    Goal("35 ms", "learned_stiffness", "mean, of linear_position", BLOCK, MEAN, (0.5,), of=POSITION),
    Goal("35 ms", TWO, "mean / p99 / max %", BLOCK, ERRORS, (0.6, 3.5, 15)),
    Goal("35 ms", TWO, "mean, of linear_position", BLOCK, MEAN, (0.1,), of=POSITION),
    *(Goal(f"{delay} ms", SOLVES, "mean / p99 / max %", {**BLOCK, "delay_ms": delay}, ERRORS, (0.1, 0.5, 2))
      for delay in (35, 80)),
    Goal("35 ms", SOLVES, "mean, of linear_position", BLOCK, MEAN, (0.02,), of=POSITION),
    Goal("friction, 35 ms", SOLVES, "mean / p99 / max %", in_world("friction"), ERRORS, (0.3, 1.5, 4)),
    *(Goal(f"{share} of compliance, 35 ms", SOLVES, "mean / p99 / max %", in_world(f"compliance_{share}"), ERRORS,
           (1.5, 5, 10)) for share in (0.7, 1.3)),
    Goal("0.05 m/s, 35 ms", SOLVES, "mean / p99 / max %", FAST, ERRORS, (0.2, 1, 4)),
    Goal("moving, 35 ms", SOLVES, "mean %", in_world("moving"), MEAN, (0.4,)),
    Goal("moving, 35 ms", TWO, "mean %", in_world("moving"), MEAN, (1,)),
    *(Goal(f"{world}, {delay} ms", CHOOSES, "mean, of the best other law", {**in_world(world), "delay_ms": delay}, MEAN,
           (1.1,), of=OTHERS) for world in WORLDS for delay in ((35,) if world == "friction" else (35, 80))),
    *(Goal(f"{world}, presses, {delay} ms", CHOOSES, "mean / p99 / max %",
           {**in_world(world), "motion": "presses", "speed_m_s": 0.025, "delay_ms": delay}, ERRORS, most)
      for world, *goals in SWINGING for delay, most in zip((35, 80), goals)),
    *(Goal(f"moving, {delay} ms", CHOOSES, "mean / p99 / max %", {**in_world("moving"), "delay_ms": delay}, ERRORS, most)
      for delay, most in ((35, (0.1, 0.5, 2)), (80, (0.2, 1, 4)))),
    *blended(SOLVES), *blended(TWO),
    Goal("closed path, 0.02 m/s, 35 ms", TWO, "energy created, %", LOOP, ENERGY, (1,)),
    Goal("closed path, 0.02 m/s, 35 ms", SOLVES, "energy created, %", LOOP, ENERGY, (0.1,)),
    Goal("cost", TWO, "ns a tick", BLOCK, ("ns_per_tick",), (50,)),
    Goal("cost", SOLVES, "ns a tick, median / p99", BLOCK, ("ns_per_tick", "ns_per_tick_p99"), (5000, 20000)),
    Goal("cost", SOLVES, "bytes of a steady sample", BLOCK, ("bytes_per_sample",), (1200,)),
    Goal("cost, friction", SOLVES, "bytes of a steady sample", in_world("friction"), ("bytes_per_sample",), (12000,)))

STABILITY = (
    *(Goal("linear wall, typical", law, "% of the direct limit", WALL, ("stable_percent",), least=(90,))
      for law in ("tangent", SOLVES)),
    *(Goal(f"press and slide, {share} of compliance", SOLVES, "N/m, all hands",
           {**HAND, "world": f"press_and_slide_compliance_{share}"}, ("stable_to_n_m",), least=(6000,))
      for share in (0.7, 1.3)))


def measured(rows, wanted, key):
    """A number; None without rows."""
    found = [row[key] for row in rows if all(row[column] == value for column, value in wanted.items())]
    return COMBINE.get(key, statistics.fmean)(found) if found else None


def measured_of(goal, rows, wanted, key):
    """What a goal is a share of."""
    if goal.of is not OTHERS:
        return measured(rows, {**wanted, **goal.of}, key)
    others = {row["method"] for row in rows} - {goal.law}
    return min(found for law in others if (found := measured(rows, {**wanted, "method": law}, key)) is not None)


def line_of(goal, rows, quick):
    """(where, law, what, goal, measured, met), all text; met: "-" of a quick study."""
    wanted = {"method": goal.law, **goal.rows}
    values = [measured(rows, wanted, key) for key in goal.keys]
    if goal.of and values[0] is not None:
        values = [value / measured_of(goal, rows, wanted, key) for value, key in zip(values, goal.keys)]
    limits = [sign + " / ".join(f"{x:.4g}" for x in numbers)
              for sign, numbers in ((">= ", goal.least), ("<= ", goal.most)) if numbers]
    if None in values:
        return goal.where, goal.law, goal.what, ", ".join(limits), "-", "-"
    met = (all(value <= most for value, most in zip(values, goal.most))
           and all(value >= least for value, least in zip(values, goal.least)))
    numbers = " / ".join(f"{x:.3g}" if abs(x) < 1000 else f"{x:.0f}" for x in values)
    return goal.where, goal.law, goal.what, ", ".join(limits), numbers, "-" if quick else "yes" if met else "NO"


def table_of(rows, quick=False):
    goals = EXTRAPOLATION
    if "stable_to_n_m" in rows[0]:
        goals = STABILITY
        for row in rows:
            row["stable_percent"] = 100 * row["stable_to_n_m"] / row["direct_limit_n_m"]
    lines = [("where", "law", "what", "goal", "measured", "met"), *(line_of(goal, rows, quick) for goal in goals)]
    widths = [max(map(len, column)) for column in zip(*lines)]
    return "\n".join("  ".join(f"{cell:<{width}}" for cell, width in zip(line, widths)).rstrip() for line in lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, metavar="DIR")
    folder = parser.parse_args().folder
    try:
        note = quick_note(folder)
        table = table_of(json.loads((folder / "summary.json").read_text(encoding="ascii")), bool(note))
        if note:
            table = f"{note}: the goals are for the whole study, none is met or missed here.\n\n{table}"
        (folder / "goals.txt").write_text(table + "\n", encoding="ascii")
    except (OSError, ValueError, LookupError, TypeError) as error:
        print(f"goals.py: {folder}: {error}; scripts/study makes it", file=sys.stderr)
        return 2
    print(table)
    return 0


if __name__ == "__main__":
    sys.exit(main())
