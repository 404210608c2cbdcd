#!/usr/bin/python3
"""Run a study that the program of tests/studies does: stability, link or robustness. What it finds: STUDY --help.

usage: in_programs.py STUDY --out DIR [--quick]

Called by scripts/study, which builds the program first. Writes summary.json and tables into DIR, the same bytes
each time.

Exit status: 0 done, 1 the program failed, or a cell of robustness is wrong or exploded, 2 wrong use.
"""

import argparse
import csv
import json
import subprocess
import sys
from collections import Counter
from pathlib import Path

from workers import Failed, Workers

PROGRAM = Path(__file__).resolve().parents[2] / "build" / "release" / "bin" / "studies"

STABILITY = """Find the stiffest wall that each law keeps stable in each hand, over rates and latencies.

In virtual time, over a simulated link: a hand presses against a wall with 1.5 N,
and the stiffness at which the loop begins to oscillate is found by bisection, to 5 %, over
5 seeds. World press_and_slide: it presses a sphere of 6 mm on a block of finite elements
(60 x 24 x 40 mm, edges of 2 mm under the path, nu 0.45, E such that the force has that
slope at 1.5 N), as the server simulates it, and slides to and fro by 6 mm for 3 s; tried
are 835, 1431, 2428, 3651 and 6413 N/m, and the direct limit is the last of them.
press_and_slide_swinging: the same with a tissue 30 times as heavy, which swings (reduced,
rayleigh_mass 10 1/s), at 30 steps a second, without an error of the force. The same
with _compliance_0.7 and _1.3: local_contact is told so many times the tissue's compliance
(30 Hz, 38 ms).

Writes into --out: summary.json and stability.csv (a row for each operator, law, wall, link,
and with passivity or without). The same bytes each time.
"""

LINK = """Find what a bad network costs a session: loss, delay, jitter, bursts, reordering, in virtual time.

Both ends of a session with the whole tick of the client, at 1000 Hz, and the liver
of 1999 at 30 steps a second, palpated by the hand of its client file for 15 s. The links,
the same each way, lose 0 to 30 % (each on its own, or in bursts of 8 datagrams on the mean),
delay by 0 to 200 ms (round trip), scatter by up to 30 ms, and hold a tenth back by 40 ms;
from 9 s on they only delay. Each row has: ms from the start to the Welcome, and from the
first sample to the first tick of the chosen law itself; samples used; their age; the error of
what was felt against the force that the organ has for the place of the tool then, every seventh
tick, so that all ages of a sample count (percent of its root mean square), from 3 to 9 s, and
healed, from 11 s on; the largest and the steepest force. An organ that moves by itself has no
force between its steps: of it (--scene) the ticks count for which it computed one. Errors are
those of link and extrapolation alone, and next to nothing where the law has the whole compliance
of a linear organ; what its mesh and its law of the tissue cost is in none of them, and many times
that (`sim_server study SCENE`). For another organ: build/release/bin/studies link DIR
--scene SCENE --client CLIENT (six links).

Writes summary.json into --out. The same bytes each time.
"""

ROBUST = """Try extreme scenes with every deformation model: what holds, is refused, is flagged, or is wrong.

The program runs one cell, a case with a model. Two cells run at a time, each in a process of its own, for 300 s at
most: one that crashes or hangs is "exploded", and the others go on.

Writes into --out: summary.json and robustness.csv (a row for each cell) and robustness.txt.
The same bytes each time. Columns:
  case, model       a row of tests/studies/robustness_cases.cpp; a model, for implicit with its law
  outcome           one of
                    stable          all is well
                    refused         by the program, which says what to change
                    flagged         a defined answer was held and said to be unsettled, or the program warned at the
                                    start that its elements lock
                    wrong           unflagged, and one of: off by more than 5 % of the reference in the second half of
                                    the hold (25 % where a row compares elements); towards the body by as much at any
                                    time; ten times the largest force of the reference at any time; of a model at rest
                                    at every instant, off by 5 % at any time from the same way in eight times as many
                                    steps; a surface that does not come back when the tools are gone. Or a body was
                                    accepted that must be refused
                    exploded        a force, tangent or place that is not finite, or an end without an answer
                    not_applicable  makes no sense for this model
  reason            one sentence; also of a stable cell whose tools rest in another place than those of the reference
  error_percent     of the force at the end, against the reference; of bodies without a tool, see there
  max_force_newton  the largest on any tool, flagged or not
  reference         what the error is measured against
  what              the case in words
"""


def run_one(study, out, quick):
    """A study that runs in one process; shows its progress on one line."""
    last = ""
    with subprocess.Popen([PROGRAM, study, out, *quick], stderr=subprocess.PIPE, text=True) as running:
        for last in running.stderr:
            if sys.stderr.isatty():
                print(f"\r\033[K{last.strip()}", end="", file=sys.stderr, flush=True)
    if sys.stderr.isatty():
        print(file=sys.stderr)
    elif running.returncode:
        print(last.strip(), file=sys.stderr)
    return 1 if running.returncode else 0


LONGEST = 300  # s, of a cell
SIGNS = {"stable": "", "refused": "refused", "flagged": "flagged", "wrong": "WRONG", "exploded": "EXPLODED", "not_applicable": "-"}


def row_of(case, model, outcome, reason):
    return {"case": case, "model": model, "outcome": outcome, "reason": reason, "error_percent": None,
            "max_force_newton": None, "reference": ""}


def run_cell(case, model, options):
    try:
        ended = subprocess.run([PROGRAM, "robustness", case, model, *options], capture_output=True, text=True, check=False,
                               timeout=LONGEST)
    except subprocess.TimeoutExpired:
        return row_of(case, model, "exploded", f"no answer within {LONGEST} s")
    if ended.returncode != 0:
        return row_of(case, model, "exploded", f"it ended with {ended.returncode} {ended.stderr[-300:].strip()}".strip())
    return json.loads(ended.stdout)


def in_short(row):
    """What stands in a cell of the table."""
    error = row["error_percent"]
    return " ".join(([SIGNS[row["outcome"]]] if SIGNS[row["outcome"]] else []) + ([f"{error:.2g} %"] if error is not None else []))


def table_of(rows, cases, models):
    found = {(r["case"], r["model"]): in_short(r) for r in rows}
    lines = [["case", *models]] + [[c, *(found[c, m] for m in models)] for c in cases]
    widths = [max(len(line[k]) for line in lines) for k in range(len(lines[0]))]
    text = "\n".join("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines)
    reasons = {}
    for r in rows:
        if r["reason"] and r["outcome"] != "not_applicable":
            reasons.setdefault((r["case"], r["outcome"], r["reason"]), []).append(r["model"])
    told = [f"{case}, {outcome} ({', '.join(of)}): {reason}" for (case, outcome, reason), of in reasons.items()]
    return "\n".join([text, "", *(f"{c}: {what}" for c, what in cases.items()), "", *told, ""])


def run_cells(out, quick):
    """Robustness: a process for each cell, so that one that crashes ends alone."""
    listed = json.loads(subprocess.run([PROGRAM, "robustness", "list", *quick], capture_output=True, text=True, check=True).stdout)
    cases, models = {c["case"]: c["what"] for c in listed["cases"]}, listed["models"]
    cells = [(case, model) for case in cases for model in models]
    workers = Workers("robustness", len(cells))

    def work(cell):
        row = {**run_cell(*cell, quick), "what": cases[cell[0]]}
        workers.advance(1)
        return row

    rows = workers.run(work, cells)
    workers.finish()
    (out / "summary.json").write_text(json.dumps(rows, indent=1) + "\n", encoding="ascii")
    with open(out / "robustness.csv", "w", encoding="ascii", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    counts = Counter(row["outcome"] for row in rows)
    text = "quick study (--quick): too few cases to judge by\n" if quick else ""
    text += f"{len(rows)} cells: {', '.join(f'{counts[o]} {o}' for o in SIGNS if counts[o])}\n\n" + table_of(rows, cases, models)
    (out / "robustness.txt").write_text(text, encoding="ascii")
    print(text, end="")
    return 1 if any(row["outcome"] in ("wrong", "exploded") for row in rows) else 0


STUDIES = {
    "stability": (STABILITY, "one link only: 30 Hz, 38 ms; press_and_slide in one hand",
                  lambda out, quick: run_one("stability", out, quick)),
    "link": (LINK, "two delays, two losses", lambda out, quick: run_one("link", out, quick)),
    "robustness": (ROBUST, "fewer cases, shorter motions", run_cells),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    studies = parser.add_subparsers(dest="study", required=True, metavar="STUDY")
    for name, (text, quick, _) in STUDIES.items():
        study = studies.add_parser(name, help=text.splitlines()[0], description=text,
                                   formatter_class=argparse.RawDescriptionHelpFormatter)
        study.add_argument("--out", type=Path, required=True, help="folder; made if it is not there")
        study.add_argument("--quick", action="store_true", help=quick)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    return STUDIES[options.study][2](options.out, ["--quick"] if options.quick else [])


try:
    sys.exit(main())
except (Failed, OSError, subprocess.CalledProcessError) as error:
    print(f"in_programs.py: {error}", file=sys.stderr)
    sys.exit(2)
