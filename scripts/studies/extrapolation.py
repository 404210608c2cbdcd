#!/usr/bin/python3
"""Score every extrapolation law against the true force, in every configuration of the study.

Called by scripts/study, which builds the programs first. A cell is a world, a motion and
a mean speed: its truth is recorded once (a step every 0.5 ms), then a capture for each
rate and delay, all scored by haptic_client evaluate. The captures are deleted.

The worlds (their scenes say mesh, E, nu and tool; the motions go up to 3 mm deep, 12 s
each, from the fixed seeds of scripts/trajectories; the mean speed is a study's choice):

  block     soft, five motions; all speeds, rates and delays; and once around at 0.02 m/s
            with 35 ms: every motion ends where it began, so work done by a law that the
            tissue does not do is energy from nowhere
  compliance_0.7, compliance_1.3   the same captures at one speed and rate, with 35 ms,
            when local_contact is told so many times the tissue's compliance
  stiff     the same 33 times as stiff, at one speed and rate; as the tissue is linear and
            the motion given, it must give the percentages of the block
  friction  the same with friction, likewise with 35 ms (its steps take long)
  moving    the block breathes and the tool follows it, likewise
  grasp     a grasped organ, 60 s: the paper's regime; its motion is known at the samples
            only, as in the paper, and its rate is 100/3 Hz
  liver     a liver that is palpated, 60 s
  liver_tensor_mass, liver_reduced, liver_implicit   tissue that swings, on the mesh of
            1999, palpated for 20 s, and pressed 2 to 3 times a second on a slide, for 17
            s (make_presses judge: of no use to choose any number of the program)
  implicit_linear, implicit_neo_hookean, implicit_prony   liver_implicit with another law,
            or half of a linear one relaxing in 0.2 s; pressed alone
  two_tools   liver_reduced pressed so, while another tool palpates it 15 to 87 mm aside
  pull_quasi_static, pull_tensor_mass   the paper's own experiment (paper_experiment.py)

Writes into --out: summary.json and summary.csv (a row for each configuration and law),
figures_*.csv (forces of all laws over a few seconds, for the drawings). The same each
time but for ns_*.

Exit status: 0 done, 1 a program failed, 2 wrong use.
"""

import argparse
import csv
import json
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

import paper_experiment
from workers import Failed, Workers, run_program

ROOT = Path(__file__).resolve().parents[2]
BIN = ROOT / "build" / "release" / "bin"
SCENES = ROOT / "configs" / "scenes"
SWINGING = ("liver_tensor_mass", "liver_reduced", "liver_implicit")
OWN_SCENES = ("block", "grasp", "liver", *SWINGING)  # the others are variants of the block, or of liver_implicit
LAW = 'law = "corotational"'
VARIANTS = {  # of liver_implicit: what stands instead of its law
    "implicit_linear": 'law = "linear"',
    "implicit_neo_hookean": 'law = "neo_hookean"',
    "implicit_prony": 'law = "linear"\nrelaxation = [{ fraction = 0.5, time = 0.2 }]',
}
TWO_TOOLS = "two_tools"
SECOND_TOOL = '\n[[tool]]\nshape = "sphere"\nradius = 0.005\n'
SECOND_MOTION = f'''[trajectory]
file = "{ROOT}/configs/trajectories/liver_paper.csv"
columns = ["t_s", "x_m", "y_m", "z_m"]
repeat = true
offset = [0.045, 0.0, 0.0]
'''
MAKE_MOTIONS = ROOT / "scripts" / "trajectories" / "make_block_motions"
MAKE_PRESSES = ROOT / "scripts" / "trajectories" / "make_presses"

MOTIONS = ("palpation", "slide", "stop_and_go", "curve", "mix")
TRUTH_HZ = 2000
SPEED, RATE = 0.017, 33.3  # of the paper's long run
GRASP_RATE = 100 / 3       # the rows of grasp.csv
SPEEDS = (0.01, 0.017, 0.05, 0.1)
PRESS_SPEED, PRESS_SECONDS = 0.025, 17
LOOP_SPEED, LOOP_SECONDS = 0.02, 10.2  # once around
RATES = (80, 40, 33.3, 26.7, 20)
DELAYS = (0, 35, 80)  # ms
QUICK_DELAYS, QUICK_SECONDS = (0, 35), 6
USUAL_DELAYS = (35,)       # where a step takes long, or one says enough
WRONG = (0.7, 1.3)         # of the compliance
FIGURES = ((20, 0), (RATE, 35))  # rate, delay of the drawings: the paper's, and one with a link
FIGURES_MOTION, FIGURES_SECONDS, FIGURES_FROM = "mix", 5.5, 1.5

KEYS = ("world", "motion", "speed_m_s", "rate_hz", "delay_ms", "reference", "method", "blended", "mean_percent",
        "p99_percent", "max_percent", "p99_of_rms_percent", "max_of_rms_percent", "mean_10ms_percent", "p99_10ms_percent",
        "max_10ms_percent", "p99_10ms_of_rms_percent", "max_10ms_of_rms_percent", "snaps", "largest_snap_percent",
        "unexplained_jumps", "largest_unexplained_jump_percent", "jump_percent", "rough_percent",
        "exceed_percent", "paper_mean_percent", "paper_max_percent", "paper_max_force_percent", "energy_percent",
        "ns_per_tick", "ns_per_tick_p99", "ns_per_arrival", "bytes_per_sample", "model_bytes")

# The laws alone: nothing between them and the drawing.
FIGURES_CLIENT = """score = []
blend_ms = 0
[passivity]
enabled = false
[limits]
force = 100
slew = 1e5
"""


class Cell(NamedTuple):
    world: str
    motion: str
    speed: float       # m/s, nominal
    trajectory: Path
    seconds: float     # recorded
    captures: tuple    # (rate in Hz, delay in ms)
    line: bool         # whether also by the paper's protocol, against the line between samples
    wrong: bool = False  # whether also with a wrong compliance

    def scene(self, folder):
        """Its file; one of VARIANTS, or with two tools, is written into `folder`."""
        if self.world in VARIANTS:
            text = (SCENES / "liver_implicit.toml").read_text(encoding="utf-8")
            assert text.count(LAW) == 1
            text = text.replace(LAW, VARIANTS[self.world])
        elif self.world == TWO_TOOLS:
            text = (SCENES / "liver_reduced.toml").read_text(encoding="utf-8") + SECOND_TOOL
        else:
            return SCENES / f"{self.world if self.world in OWN_SCENES else 'block_' + self.world}.toml"
        file = folder / f"{self.world}.toml"
        file.write_text(text.replace('"../', f'"{SCENES.parent}/'), encoding="utf-8")
        return file

    def motions(self, folder):
        """Arguments of `record`: of its tool, and of the other one, if there is one."""
        arguments = ["--trajectory", self.trajectory]
        if self.world == TWO_TOOLS:
            other = folder / "second_tool.toml"
            other.write_text(SECOND_MOTION, encoding="utf-8")
            arguments += ["--trajectory", other]
        return arguments


def cells_of(quick, motions):
    """`motions`: {speed: folder of CSV files}; "moving", at SPEED; and "presses", a CSV file."""
    delays = QUICK_DELAYS if quick else DELAYS
    cells = []

    def add(world, motion, speed, folder, rates=(RATE,)):
        file = folder / f"block_{motion}.csv"
        seconds = QUICK_SECONDS if quick else float(file.read_text().split("\n")[-2].split(",")[0])
        one = world == "friction" or speed == LOOP_SPEED
        captures = tuple((rate, delay) for rate in rates for delay in (USUAL_DELAYS if one else delays))
        usual = world == "block" and speed == SPEED
        cells.append(Cell(world, motion, speed, file, seconds, captures, usual, usual))

    for speed in (s for s in motions if s not in ("moving", "presses")):
        for motion in MOTIONS:
            add("block", motion, speed, motions[speed], RATES if speed == SPEED and not quick else (RATE,))
    for world in ("stiff", "friction", "moving"):
        for motion in MOTIONS if not quick else ("mix",):
            add(world, motion, SPEED, motions.get(world, motions[SPEED]))
    for world, motion, rate in (("grasp", "manipulation", GRASP_RATE), ("liver", "palpation", RATE)):
        cells.append(Cell(world, motion, SPEED, ROOT / "configs" / "clients" / f"{world}.toml",
                          QUICK_SECONDS if quick else 60, tuple((rate, delay) for delay in delays), True))
    for world in SWINGING:
        cells.append(Cell(world, "palpation", SPEED, ROOT / "configs" / "clients" / "liver_paper.toml",
                          QUICK_SECONDS if quick else 20, tuple((RATE, delay) for delay in delays), False))
    for world in (*SWINGING, *((*VARIANTS, TWO_TOOLS) if not quick else ())):
        cells.append(Cell(world, "presses", PRESS_SPEED, motions["presses"], QUICK_SECONDS if quick else PRESS_SECONDS,
                          tuple((RATE, delay) for delay in delays), False))
    return cells


def weights_of(cell):
    """Of truth, one capture, evaluation: about the steps each is worth."""
    return cell.seconds * TRUTH_HZ, 3000 + 50 * cell.seconds, 1000 * len(cell.captures)


def weight_of(cell):
    truth, capture, scoring = weights_of(cell)
    return truth + len(cell.captures) * capture + scoring * (2 if cell.line else 1)


class Study:
    def __init__(self, folder, workers):
        self.folder, self.workers = folder, workers

    def record(self, weight, cell, rate, out, *more):
        self.workers.command(weight, BIN / "sim_server", "record", cell.scene(self.folder), *cell.motions(self.folder),
                             "--rate", rate, "--seconds", cell.seconds, "--out", out, "--force", *more)

    def evaluate(self, weight, cell, captures, folder, *more):
        """Rows, with the nominal speed, rate and delay; `captures`: {(rate, delay): file}."""
        self.workers.command(weight, BIN / "haptic_client", "evaluate", *captures.values(), "--world", cell.world,
                             "--out", folder, *more)
        rows = json.loads((folder / "summary.json").read_text())
        each = len(rows) // len(captures)
        for i, row in enumerate(rows):
            rate, delay = list(captures)[i // each]
            row.update(motion=cell.motion, speed_m_s=cell.speed, rate_hz=round(rate, 1), delay_ms=delay)
        return [{key: row[key] for key in KEYS} for row in rows]

    def run(self, cell):
        truth_weight, capture_weight, scoring_weight = weights_of(cell)
        with tempfile.TemporaryDirectory(dir=self.folder) as name:
            folder = Path(name)
            self.record(truth_weight, cell, TRUTH_HZ, folder / "truth.pcap", "--plain")
            captures = {}
            for rate, delay in cell.captures:
                captures[rate, delay] = folder / f"{rate}_{delay}.pcap"
                self.record(capture_weight, cell, rate, captures[rate, delay], "--delay-ms", delay)
            rows = self.evaluate(scoring_weight, cell, captures, folder, "--truth", folder / "truth.pcap")
            if cell.line:
                paper = {key: captures[key] for key in captures if round(key[0], 1) == RATE and key[1] == 0}
                rows += [{**row, "reference": "paper"} for row in self.evaluate(scoring_weight, cell, paper, folder)]
            for share in WRONG if cell.wrong else ():
                told = {key: captures[key] for key in captures if key == (RATE, USUAL_DELAYS[0])}
                rows += self.evaluate(0, cell._replace(world=f"compliance_{share}"), told, folder, "--truth",
                                      folder / "truth.pcap", "--compliance", share, "--method", "local_contact")
        return rows

    def replay(self, capture, law):
        """[{column: text}], a row a tick at 500 Hz."""
        client, out = self.folder / "figures.toml", capture.with_suffix(".csv")
        self.workers.command(0, BIN / "haptic_client", "replay", capture, "--client", client, "--method", law,
                             "--rate", 500, "--out", out)
        with open(out, newline="", encoding="ascii") as file:
            return [row for row in csv.DictReader(file) if float(row["t_s"]) >= FIGURES_FROM]

    def figures(self, cell, laws, out):
        """The force that each law gives, beside the true one, over a few seconds."""
        (self.folder / "figures.toml").write_text(FIGURES_CLIENT)
        axes = ("fx_n", "fy_n", "fz_n")
        truth = self.folder / "figures_truth.pcap"
        self.record(weights_of(cell)[0], cell, TRUTH_HZ, truth, "--plain")
        true = {row["t_s"]: row for row in self.replay(truth, "constant")}
        for rate, delay in cell.captures:
            capture = self.folder / "figures.pcap"
            self.record(weights_of(cell)[1], cell, rate, capture, "--delay-ms", delay)
            forces = {law: self.replay(capture, law) for law in laws}
            with open(out / f"figures_{rate:g}hz_{delay:g}ms.csv", "w", newline="", encoding="ascii") as file:
                writer = csv.writer(file, lineterminator="\n")
                writer.writerow(["t_s", "sample_t_s", "sample_n", *(f"true_{axis}" for axis in axes),
                                 *(f"{law}_{axis}" for law in laws for axis in axes)])
                for i, first in enumerate(forces[laws[0]]):
                    if first["t_s"] not in true:
                        continue
                    writer.writerow([first["t_s"], first["sample_t_s"], first["sample_n"],
                                     *(f"{float(true[first['t_s']][axis]):.6f}" for axis in axes),
                                     *(f"{float(forces[law][i][axis]):.6f}" for law in laws for axis in axes)])


def make_motions(folder, speeds):
    made = {}
    for speed in speeds:
        made[speed] = folder / f"{speed:g}"
        made[speed].mkdir()
        run_program(sys.executable, MAKE_MOTIONS, "--speed", speed, "--output", made[speed],
                    *(("--seconds", LOOP_SECONDS) if speed == LOOP_SPEED else ()))
    made["moving"] = folder / "moving"
    made["moving"].mkdir()
    run_program(sys.executable, MAKE_MOTIONS, "--speed", SPEED, "--follow", SCENES / "block_moving.toml", "--output",
                made["moving"])
    made["presses"] = folder / "presses.csv"
    run_program(sys.executable, MAKE_PRESSES, "judge", "-o", made["presses"])
    return made


def run_paper(study, run, motions, quick):
    with tempfile.TemporaryDirectory(dir=study.folder) as name:
        folder = Path(name)
        rows = paper_experiment.perform(run, motions, paper_experiment.scene_of(run.model, folder), quick, study.workers,
                                        BIN, folder)
    return [{key: row[key] for key in KEYS} for row in rows]


def write_summary(rows, out):
    (out / "summary.json").write_text(json.dumps(rows, indent=1) + "\n", encoding="ascii")
    with open(out / "summary.csv", "w", newline="", encoding="ascii") as file:
        writer = csv.DictWriter(file, KEYS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def run(quick, out, worlds):
    with tempfile.TemporaryDirectory(dir=out, prefix="captures.") as name:
        folder = Path(name)
        motions = make_motions(folder, (SPEED,) if quick else (*SPEEDS, LOOP_SPEED))
        cells = [cell for cell in cells_of(quick, motions) if not worlds or cell.world in worlds]
        if not cells:
            raise Failed(f"--world {', '.join(worlds)}: no such world; they are "
                         f"{', '.join(dict.fromkeys(cell.world for cell in cells_of(quick, motions)))}")
        drawn = Cell("block", FIGURES_MOTION, SPEED, motions[SPEED] / f"block_{FIGURES_MOTION}.csv", FIGURES_SECONDS,
                     FIGURES, False)
        workers = Workers("study", 0)
        study = Study(folder, workers)
        paper, pulls = [] if worlds else paper_experiment.runs_of(quick), paper_experiment.make_motions(folder, quick)
        workers.total = (sum(map(weight_of, cells)) + (0 if worlds else weight_of(drawn))
                         + sum(paper_experiment.weight_of(run, quick) for run in paper))
        # The longest first, so that no worker is left alone with one at the end.
        order = sorted(range(len(cells)), key=lambda i: -weight_of(cells[i]))
        rows_of = dict(zip(order, workers.run(lambda i: study.run(cells[i]), order)))
        rows = [row for i in range(len(cells)) for row in rows_of[i]]
        for found in workers.run(lambda one: run_paper(study, one, pulls, quick), paper):
            rows += found
        if not worlds:
            study.figures(drawn, list(dict.fromkeys(row["method"] for row in rows)), out)
        workers.finish()
    write_summary(rows, out)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="an existing folder")
    parser.add_argument("--world", action="append", metavar="NAME",
                        help="only the captures of this world, without pictures and the paper's table; repeatable")
    parser.add_argument("--quick", action="store_true",
                        help="one speed, one rate, two delays, 6 s: whether all of it runs")
    arguments = parser.parse_args()
    try:
        run(arguments.quick, arguments.out, arguments.world or [])
    except (Failed, OSError) as problem:
        print(f"study: {problem}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
