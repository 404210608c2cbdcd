#!/usr/bin/env python3
"""Run the benchmark program, print a table of its rows and the ratios between them.

Called by scripts/bench, which says more with --help. Exit status: 0 all rows ran
(but those that the scene leaves out), 1 a row could not run or the program failed,
2 the arguments cannot be used.
"""

import argparse
import json
import math
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

FULL = ["--benchmark_repetitions=9", "--benchmark_min_time=0.2"]
QUICK = ["--benchmark_repetitions=3", "--benchmark_min_time=0.02"]
SUFFIX = re.compile(r"/(iterations:\d+|manual_time|real_time|repeats:\d+|min_time:[^/]*)")
UNITS = (("s", 1e9), ("ms", 1e6), ("us", 1e3), ("ns", 1))
BASE_LAW = "constant"
OURS = "ours"  # last part of the name of a row whose neighbours are libraries that do the same
LEFT_OUT = "left out: "  # what a row says that the scene has no use for
FRAME_NS, TICK_NS = 1e9 / 30, 1e9 / 4000  # the scene's rate, and the quickest a client may ask for
COUNTERS = (("p50", ".0f", " us"), ("p99", ".0f", " us"), ("rate", ".0f", "/s"), ("reads", ".0f", " GB/s"),
            ("touching", ".1f", ""), ("error", ".2g", " %"), ("worst", ".1f", " ms"), ("moved", ".0f", " mm"),
            ("factors", ".0f", ""), ("sofa", ".4g", " ms"), ("ratio", ".1f", " times"))  # what a row counts beside its time
SESSION = re.compile(r"virtual_session/(\d+)_s$")


class Failed(Exception):
    """There is nothing to show; (exit status, text for the user)."""


class Progress:
    """Tells on stderr how far the rows are: one running line on a terminal, elsewhere a line a group."""

    def __init__(self, count):
        self.count, self.done, self.group = count, 0, None
        self.terminal = sys.stderr.isatty()

    def row(self, name):
        self.done += 1
        text = f"bench: {self.done} of {self.count} rows: {name}"
        if self.terminal:
            print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)
        elif name.split("/")[0] != self.group:
            self.group = name.split("/")[0]
            print(text, file=sys.stderr, flush=True)

    def end(self):
        if self.terminal:
            print("\r\033[K", end="", file=sys.stderr, flush=True)


def plain(name):
    """The name of a row without what Google Benchmark hangs behind it."""
    return SUFFIX.sub("", name)


def list_rows(program, pattern):
    listed = subprocess.run([program, "--benchmark_list_tests", f"--benchmark_filter={pattern}"],
                            capture_output=True, text=True, check=False)
    if listed.returncode != 0:
        raise Failed(1, listed.stderr.strip())
    names = [plain(line) for line in listed.stdout.split("\n") if line]
    if not names or "Failed to match" in listed.stderr + listed.stdout:
        raise Failed(2, f"no row matches \"{pattern}\"")
    return names


def run(program, pattern, quick):
    """Run the rows; return Google Benchmark's JSON."""
    progress = Progress(len(list_rows(program, pattern)))
    with tempfile.TemporaryDirectory() as folder:
        out, errors = Path(folder, "out.json"), Path(folder, "errors")
        command = [program, f"--benchmark_filter={pattern}", *(QUICK if quick else FULL),
                   "--benchmark_report_aggregates_only", f"--benchmark_out={out}", "--benchmark_out_format=json"]
        with open(errors, "w", encoding="utf-8") as log, \
                subprocess.Popen(command, stdout=subprocess.PIPE, stderr=log, text=True) as process:
            for line in process.stdout:
                found = re.match(r"(\S+)_median\s|(\S+)\s+ERROR", line)
                if found:
                    progress.row(plain(found[1] or found[2]))
        progress.end()
        if process.returncode != 0:
            raise Failed(1, f"{errors.read_text()[-2000:]}\nbench: the program ended with {process.returncode}")
        return json.loads(out.read_text())


NS = {"ns": 1, "us": 1e3, "ms": 1e6, "s": 1e9}  # a row's own unit


def rows_of(result):
    """{name: {"ns": median, "cv": percent, "hash": text, "also": text}} and {name: why it was skipped}."""
    rows, skipped = {}, {}
    for entry in result["benchmarks"]:
        name = plain(entry["run_name"])
        if entry.get("error_occurred") or entry.get("skipped"):
            skipped[name] = entry.get("error_message") or entry.get("skip_message", "")
            continue
        kind = entry.get("aggregate_name")
        key = "real_time" if "manual_time" in entry["run_name"] else "cpu_time"
        row = rows.setdefault(name, {"hash": entry.get("label", ""), "also": ""})
        if kind == "median":
            row["ns"] = entry[key] * NS[entry["time_unit"]]
            row["also"] = ", ".join(f"{what} {entry[what]:{form}}{unit}" for what, form, unit in COUNTERS if what in entry)
        elif kind == "cv":
            row["cv"] = 100 * entry[key]
    return rows, skipped


def ratios_of(rows):
    """{what: number}, for what can be told from the rows that ran."""
    ns = {name: row["ns"] for name, row in rows.items()}
    ratios = {}

    def add(name, dividend, divisor):
        if divisor:
            ratios[name] = dividend / divisor

    for name, value in ns.items():
        group, _, rest = name.partition("/")
        base = f"{group}/{BASE_LAW}"
        if group in ("law", "tick") and name != base and base in ns:
            add(f"{name} : {base}", value, ns[base])
        if group == "tick":
            add(f"{name} : period at 4 kHz", value, TICK_NS)
        if group == "step" and rest.endswith("/contact"):
            free = name.replace("/contact", "/free")
            if free in ns:
                add(f"{name} : {free}", value, ns[free])
            add(f"{name} : frame at 30 Hz", value, FRAME_NS)
        if group == "implicit":
            add(f"{name} : frame at 30 Hz", value, FRAME_NS)
        if group.startswith("sub_step"):
            add(f"{name} : stream/{rest}", value, ns.get(f"stream/{rest}"))
        if group == "setup" and rest != "total" and "setup/total" in ns:
            add(f"{name} : setup/total", value, ns["setup/total"])
        case, _, whose = name.rpartition("/")
        if whose != OURS:
            add(f"{name} : {OURS}", value, ns.get(f"{case}/{OURS}"))
        session = SESSION.match(name)
        if session:
            add(f"{name} : real time", value, float(session[1]) * 1e9)
    for group in ("sub_step", "sub_step_of_8"):
        exponent = exponent_of({name: value for name, value in ns.items() if name.startswith(f"{group}/")})
        if exponent is not None:
            ratios[f"{group} : exponent in the size of the mesh"] = exponent
    return ratios


def exponent_of(rows):
    """Of times that grow as a power of the size, as "group/29k" names it: by least squares; of two sizes at least."""
    points = [(math.log(float(name.split("/")[1].rstrip("k"))), math.log(value)) for name, value in rows.items()]
    if len(points) < 2:
        return None
    mean_x, mean_y = (sum(column) / len(points) for column in zip(*points))
    return sum((x - mean_x) * (y - mean_y) for x, y in points) / sum((x - mean_x) ** 2 for x, _ in points)


def time_text(ns):
    unit, size = next((u for u in UNITS if ns >= u[1]), UNITS[-1])
    number = ns / size
    return f"{number:.{0 if number >= 100 else 1 if number >= 10 else 2}f} {unit}"


def print_tables(rows, skipped, ratios):
    width = max(map(len, [*rows, *skipped, *ratios, "name"]))
    print(f"{'name':<{width}}  {'median':>8}  {'cv %':>5}  hash")
    for name, row in rows.items():
        print(f"{name:<{width}}  {time_text(row['ns']):>8}  {row['cv']:>5.1f}  " + "  ".join(filter(None, (row['hash'], row['also']))))
    for name, why in skipped.items():
        print(f"{name:<{width}}  {why if why.startswith(LEFT_OUT) else 'failed: ' + why}")
    if ratios:
        print(f"\n{'ratio':<{width}}  {'value':>8}")
    for name, value in ratios.items():
        print(f"{name:<{width}}  {value:>8.3g}")


def write_whole(path, text):
    part = Path(f"{path}.part")
    try:
        part.write_text(text, encoding="utf-8")
        os.replace(part, path)
    except OSError as e:
        part.unlink(missing_ok=True)
        raise Failed(1, f"{path}: {e.strerror}") from e


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("filter")
    parser.add_argument("--json", type=Path)
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    try:
        result = run(options.program, options.filter, options.quick)
        rows, skipped = rows_of(result)
        result["ratios"] = ratios_of(rows)
        print_tables(rows, skipped, result["ratios"])
        if options.json:
            write_whole(options.json, json.dumps(result, indent=2) + "\n")
    except Failed as e:
        print(f"bench: {e.args[1]}", file=sys.stderr)
        return e.args[0]
    except KeyboardInterrupt:
        return 130
    return 0 if all(why.startswith(LEFT_OUT) for why in skipped.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
