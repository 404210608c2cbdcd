#!/usr/bin/python3
"""Run a session with the page open, the mouse in the hand and a build beside it, and compute its headline again.

usage: session.py --out DIR [--quick]

The liver of configs/scenes/liver.toml and its client, over loopback with `--device browser`: a script holds the WebSocket of
the live page, drags the mouse over the organ for ten minutes (--quick: one), and compilers keep every core busy at low
priority. Compared are the error of the force on the hand that the report ends with, the last that the page showed, and the
same computed from the trace of the whole session. That trace is the replay of what the client recorded: `run --trace` holds
the last minute alone, whose rows must be among those of the replay, to the last digit.

Writes into --out: summary.json, report.json, server.json, trace.csv (the last minute), whole.csv (all of it).

Exit status: 0 done, 1 a program failed, or the numbers differ, 2 wrong use.
"""

import argparse
import csv
import json
import math
import os
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "page"))
import websocket  # noqa: E402
from workers import Failed, run_program  # noqa: E402

PROGRAMS = ROOT / "build" / "release" / "bin"
SCENE, CLIENT = ROOT / "configs/scenes/liver.toml", ROOT / "configs/clients/liver.toml"
MOUSE_HZ = 60
REPORT_OFF = 1e-4  # of the number: what the trace rounds, in single precision
PAGE_OFF = 0.05    # of the number: the page is told each error in turn, some tenths of a second before the end
# Compiled over and over: one of the larger sources, which nothing else is needed for.
SOURCE = ["c++", "-std=c++20", "-O2", f"-I{ROOT}", "-isystem", "/usr/include/eigen3", "-c",
          str(ROOT / "sim_server/mesh/mesh_faults.cpp"), "-o", "/dev/null"]


def mouse(t):
    """Where it points at `t` (s), m: it presses on the liver, slides, and lifts."""
    return [-0.02 + 0.004 * math.sin(0.9 * t), 0.0745 - 0.006 * math.sin(1.7 * t) + 0.006, 0.003 * math.sin(0.6 * t)]


class Page:
    """The page without a browser: it takes surfaces, moves the mouse, and keeps what it is told of the client."""

    def __init__(self, url, token):
        self.total, self.messages, self.ended, self.error = None, 0, False, None
        self.socket = websocket.connect(url, timeout=0.2, protocol="palpate-view-1")
        self.socket.send(json.dumps({"hello": {"token": token}}))
        self.threads = [threading.Thread(target=self.work, args=(what,)) for what in (self.listen, self.move)]
        self.lock = threading.Lock()
        for thread in self.threads:
            thread.start()

    def work(self, what):
        try:
            what()
        except (websocket.Closed, OSError) as error:
            if not self.ended:
                self.error = error

    def send(self, message):
        with self.lock:
            self.socket.send(json.dumps(message))

    def listen(self):
        while not self.ended:
            try:
                message = self.socket.receive()
            except TimeoutError:
                continue
            self.messages += 1
            if not isinstance(message, str):
                continue
            told = json.loads(message)
            if "state" in told:
                self.send({"shown": told["state"]["step"]})
            if "client" in told and told["client"]["total_percent"] is not None:
                self.total = told["client"]["total_percent"]

    def move(self):
        begin = time.monotonic()
        for number in range(1, 1 << 40):
            time.sleep(max(0.0, begin + number / MOUSE_HZ - time.monotonic()))
            if self.ended:
                return
            self.send({"pointer": {"tool": 0, "p": mouse(number / MOUSE_HZ), "buttons": 0, "number": number}})

    def close(self):
        self.ended = True
        for thread in self.threads:
            thread.join()
        self.socket.close()


class Load:
    """A compiler on each core, at low priority, one source after the other."""

    def __init__(self):
        self.ended, self.compiled, self.process = False, 0, []
        self.threads = [threading.Thread(target=self.work) for _ in range(os.cpu_count())]
        for thread in self.threads:
            thread.start()

    def work(self):
        while not self.ended:
            subprocess.run(["nice", "-n", "10", *SOURCE], check=True, capture_output=True, cwd=ROOT)
            self.compiled += 1

    def close(self):
        self.ended = True
        for thread in self.threads:
            thread.join()


def wait_for(file, pattern, process, seconds=120):
    end = time.monotonic() + seconds
    while time.monotonic() < end and process.poll() is None:
        found = re.search(pattern, file.read_text(errors="replace"))
        if found:
            return found
        time.sleep(0.1)
    raise Failed(f"sim_server never said {pattern}: {file.read_text(errors='replace')[-2000:]}")


def run_session(out, seconds):
    """Returns the page and the load, at their end."""
    said = out / "server.txt"
    with open(said, "wb") as log:
        server = subprocess.Popen([PROGRAMS / "sim_server", "run", SCENE, "--listen", "127.0.0.1:0", "--viewer", "0", "--report",
                                   out / "server.json"], stdout=log, stderr=log, cwd=ROOT)
    load = page = None
    try:
        address = wait_for(said, r"the live page: http://([^/\s]+)/(?:#token=([0-9a-f]+))?", server)
        udp = wait_for(said, r"listening on (\S+:\d+)", server).group(1)
        load = Load()
        page = Page(f"ws://{address.group(1)}/live", address.group(2) or "")
        run_program(PROGRAMS / "haptic_client", "run", CLIENT, "--device", "browser", "--server", udp, "--seconds", seconds,
                    "--report", out / "report.json", "--trace", out / "trace.csv", "--record", out / "session.pcap")
    finally:
        if page is not None:
            page.close()
        if load is not None:
            load.close()
        server.send_signal(signal.SIGINT)
        server.wait(60)
    if page.error is not None:
        raise Failed(f"the page lost its connection: {page.error}")
    return page, load


def rows_of(file):
    with open(file, newline="") as table:
        yield from csv.DictReader(table)


def number(cell):
    return float(cell) if cell else None


def headline_of(trace):
    """The error of the force on the hand from the rows of a trace, % of the root mean square of the force that was right; and
    the ticks that it is of. As haptic_client/session/REPORT.md defines them: the mean of `error_n` over ticks in which one of
    both forces pushes, and the mean errors by mesh and time step, each sample by the size of its force."""
    error = squared = pushes = touches = ticks = 0
    sums, weights = {"mesh_percent": 0.0, "motion_percent": 0.0}, {"mesh_percent": 0.0, "motion_percent": 0.0}
    for row in rows_of(trace):
        for name, weight in weights.items():
            if row["sample_n"] and row[name]:
                sums[name] += float(row[name]) * float(row["sample_n"])
                weights[name] = weight + float(row["sample_n"])
        if not row["error_n"]:
            continue
        ticks += 1
        right, written = float(row["reference_n"]), math.hypot(*(float(row[f"f{axis}_n"]) for axis in "xyz"))
        if right == 0 and written == 0:
            continue
        error, squared, pushes, touches = error + float(row["error_n"]), squared + right**2, pushes + 1, touches + (right > 0)
    if touches == 0:
        raise Failed("the mouse never touched the liver")
    hand = 100 * error / pushes / math.sqrt(squared / touches)
    parts = {name: total / weights[name] if weights[name] > 0 else 0.0 for name, total in sums.items()}
    return {"hand_percent": hand, **parts, "total_percent": hand + sum(parts.values()), "judged_ticks": ticks}


def differing_rows(part, whole):
    """How many rows of the last minute are not in the whole, apart from times, which count from the first row; and rows."""
    without = ("t_s", "sample_t_s")
    key = lambda row: tuple(value for name, value in row.items() if name not in without)  # noqa: E731
    wanted = {row["tick"]: key(row) for row in rows_of(part)}
    rows = len(wanted)
    for row in rows_of(whole):
        if wanted.get(row["tick"]) == key(row):
            del wanted[row["tick"]]
    return len(wanted), rows


def off(a, b):
    return abs(a - b) / max(abs(a), abs(b), 1e-9)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--quick", action="store_true", help="one minute, not ten")
    options = parser.parse_args()
    out = options.out
    seconds = 60 if options.quick else 600
    page, load = run_session(out, seconds)
    run_program(PROGRAMS / "haptic_client", "replay", out / "session.pcap", "--client", CLIENT, "--out", out / "whole.csv")
    report = json.loads((out / "report.json").read_text())["tools"][0]
    rendered, again = report["rendered"], headline_of(out / "whole.csv")
    differing, rows = differing_rows(out / "trace.csv", out / "whole.csv")
    summary = {
        "seconds": seconds,
        "report": {name: rendered[name] for name in ("total_percent", "mesh_percent", "motion_percent", "hand_percent",
                                                     "judged_ticks", "unjudged_ticks", "unsettled_ticks")},
        "page_total_percent": page.total,
        "trace": again,
        "last_minute": {"rows": rows, "rows_that_differ": differing},
        "page_messages": page.messages,
        "sources_compiled": load.compiled,
        "missed_ticks": report["loop"]["missed"],
    }
    (out / "summary.json").write_text(json.dumps(summary, indent=2) + "\n")
    print(f"error of the force on the hand in {seconds} s: report {rendered['total_percent']:.4g} %, page "
          f"{page.total if page.total is None else format(page.total, '.4g')} %, trace {again['total_percent']:.4g} %; "
          f"{differing} of {rows} rows of the last minute differ; {load.compiled} sources compiled beside it")
    found = []
    if off(rendered["total_percent"], again["total_percent"]) > REPORT_OFF:
        found.append("the report is not what its trace says")
    if page.total is None or off(page.total, rendered["total_percent"]) > PAGE_OFF:
        found.append("the page is not what the report says")
    if differing > 0:
        found.append("the trace of the last minute is not that of the recording")
    for line in found:
        print(f"session: {line}", file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Failed as error:
        print(f"session: {error}", file=sys.stderr)
        sys.exit(1)
