#!/usr/bin/python3
"""Try extreme scenes with every deformation model: what holds, is refused, is flagged, or is wrong.

Called by scripts/study, which builds the program first; that program (tests/studies) runs one
cell, a case with a model. Two cells run at a time, each in a process of its own, for 300 s at
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

Exit status: 0 no cell is wrong or exploded, 1 one is, 2 wrong use.
"""

import argparse
import csv
import json
import subprocess
import sys
from collections import Counter
from pathlib import Path

from workers import Failed, Workers

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "build" / "release" / "bin" / "robustness_study"
LONGEST = 300  # s, of a cell
SIGNS = {"stable": "", "refused": "refused", "flagged": "flagged", "wrong": "WRONG", "exploded": "EXPLODED", "not_applicable": "-"}


def row_of(case, model, outcome, reason):
    return {"case": case, "model": model, "outcome": outcome, "reason": reason, "error_percent": None,
            "max_force_newton": None, "reference": ""}


def run_cell(case, model, options):
    try:
        ended = subprocess.run([PROGRAM, *options, case, model], capture_output=True, text=True, check=False,
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


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True, help="folder; made if it is not there")
    parser.add_argument("--quick", action="store_true", help="fewer cases, shorter motions")
    options = parser.parse_args()
    quick = ["--quick"] if options.quick else []
    options.out.mkdir(parents=True, exist_ok=True)
    listed = json.loads(subprocess.run([PROGRAM, *quick, "list"], capture_output=True, text=True, check=True).stdout)
    cases, models = {c["case"]: c["what"] for c in listed["cases"]}, listed["models"]
    cells = [(case, model) for case in cases for model in models]
    workers = Workers("robustness", len(cells))

    def work(cell):
        row = {**run_cell(*cell, quick), "what": cases[cell[0]]}
        workers.advance(1)
        return row

    rows = workers.run(work, cells)
    workers.finish()
    (options.out / "summary.json").write_text(json.dumps(rows, indent=1) + "\n", encoding="ascii")
    with open(options.out / "robustness.csv", "w", encoding="ascii", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    counts = Counter(row["outcome"] for row in rows)
    text = "quick study (--quick): too few cases to judge by\n" if options.quick else ""
    text += f"{len(rows)} cells: {', '.join(f'{counts[o]} {o}' for o in SIGNS if counts[o])}\n\n" + table_of(rows, cases, models)
    (options.out / "robustness.txt").write_text(text, encoding="ascii")
    print(text, end="")
    return 1 if any(row["outcome"] in ("wrong", "exploded") for row in rows) else 0


try:
    sys.exit(main())
except (Failed, OSError, subprocess.CalledProcessError) as error:
    print(f"robustness.py: {error}", file=sys.stderr)
    sys.exit(2)
