"""The experiment of Picinbono and Lombardo (1999): a grasped liver is pulled by two instruments.

Their long run and their lower rates, on configs/scenes/liver_paper_grasp.toml, along motions of
scripts/trajectories/make_pull_motion. The paper gives the mesh's size, the speeds, the rates and the protocol. It says
nothing of how far the organ was pulled, where it was held and how stiff it is (percentages do not depend on that), nor
which of its two models ran, nor whether the motion was recorded between samples: so each of these is tried, and none is
chosen by what comes out.
"""

import json
import sys
from pathlib import Path
from typing import NamedTuple

from workers import run_program

ROOT = Path(__file__).resolve().parents[2]
SCENE = ROOT / "configs" / "scenes" / "liver_paper_grasp.toml"
MAKE_MOTION = ROOT / "scripts" / "trajectories" / "make_pull_motion"
SIDES = ("left", "right")   # the tools of the scene
PLACES = ("[-0.0304, -0.0607, 0.0700]", "[0.0449, -0.0064, 0.0699]")  # m, its grasp_place
STRETCHES = (10, 20, 40)    # mm on average
USUAL = 20
SECONDS, QUICK_SECONDS = 180, 20
LONG_RUN_HZ, FAST_HZ = 100 / 3, 80
KEEP = (1, 2, 3, 4)         # one of so many samples at 80 Hz
SPEED = 0.017


class Run(NamedTuple):
    model: str
    stretch: int            # mm
    tool: int               # 0 or 1
    at_samples: bool = False  # whether the motion is known at the samples only, straight in between

    @property
    def name(self):
        return f"{SIDES[self.tool]}_{self.stretch}mm" + ("_at_samples" if self.at_samples else "")


def runs_of(quick):
    if quick:
        return [Run("quasi_static", USUAL, 0)]
    return [*(Run("quasi_static", stretch, tool) for stretch in STRETCHES for tool in (0, 1)),
            *(Run("tensor_mass", USUAL, tool) for tool in (0, 1)),
            *(Run("quasi_static", USUAL, tool, True) for tool in (0, 1))]


def make_motions(folder, quick):
    """{(stretch, at_samples, tool): a client file that says how to read the motion}."""
    made = {}
    for stretch, at_samples in {(run.stretch, run.at_samples) for run in runs_of(quick)}:
        for tool, place in enumerate(PLACES):
            motion = folder / f"pull_{stretch}_{at_samples:d}_{tool}.csv"
            run_program(sys.executable, MAKE_MOTION, "--seed", 1 + tool, "--stretch", stretch, "--seconds",
                        QUICK_SECONDS if quick else SECONDS, "--output", motion,
                        *(("--rate", LONG_RUN_HZ) if at_samples else ()))
            client = made[stretch, at_samples, tool] = motion.with_suffix(".toml")
            client.write_text(f'[trajectory]\nfile = "{motion}"\ncolumns = ["t_s", "x_mm", "y_mm", "z_mm"]\n'
                              f"scale = 0.001\noffset = {place}\n", encoding="utf-8")
    return made


def scene_of(model, folder):
    """The scene with another model; its files by their whole paths."""
    text = SCENE.read_text(encoding="utf-8").replace('"../', f'"{ROOT}/configs/')
    file = folder / f"pull_{model}.toml"
    file.write_text(text.replace('model = "quasi_static"', f'model = "{model}"'), encoding="utf-8")
    return file


def weight_of(run, quick):
    return (20 if run.model == "tensor_mass" else 10) * (QUICK_SECONDS if quick else SECONDS) * 30


def perform(run, motions, scene, quick, workers, programs, folder):
    """Rows of `haptic_client evaluate`, of the long run and, where all is usual, of the lower rates."""
    rows = []

    both = [part for tool in (0, 1) for part in ("--trajectory", motions[run.stretch, run.at_samples, tool])]

    def score(rate, keep):
        capture, out = folder / f"{rate:.0f}.pcap", folder / f"{rate:.0f}_{keep}"
        if keep == 1:
            run_program(programs / "sim_server", "record", scene, *both, "--tool", run.tool + 1, "--rate", rate, "--out",
                        capture, "--force")
        run_program(programs / "haptic_client", "evaluate", capture, "--keep", keep, "--world",
                    f"pull_{run.model}", "--out", out)
        for row in json.loads((out / "summary.json").read_text(encoding="ascii")):
            if not row["blended"]:
                rows.append({**row, "motion": run.name, "speed_m_s": SPEED, "rate_hz": round(rate / keep, 1),
                             "delay_ms": 0, "reference": "paper"})

    score(LONG_RUN_HZ, 1)
    if run.stretch == USUAL and not run.at_samples:
        for keep in KEEP:
            score(FAST_HZ, keep)
    workers.advance(weight_of(run, quick))
    return rows
