#!/usr/bin/python3
"""Find what a bad network costs a session: loss, delay, jitter, bursts, reordering, in virtual time.

Called by scripts/study, which builds the program first; that program (tests/studies) does
the work: both ends of a session with the whole tick of the client, at 1000 Hz, and the liver
of 1999 at 30 steps a second, palpated by the hand of its client file for 15 s. The links,
the same each way, lose 0 to 30 % (each on its own, or in bursts of 8 datagrams on the mean),
delay by 0 to 200 ms (round trip), scatter by up to 30 ms, and hold a tenth back by 40 ms;
from 9 s on they only delay. Each row has: ms from the start to the Welcome, and from the
first sample to the first tick of the chosen law itself; samples used; their age; the error of
what was felt at a tick against the force that the organ then computed for that tick (percent
of its root mean square), from 3 to 9 s, and healed, from 11 s on; the largest and the steepest
force. For another organ: build/release/bin/link_study --scene SCENE CLIENT DIR (six links).

Writes summary.json into --out. The same bytes each time.

Exit status: 0 done, 1 the program failed, 2 wrong use.
"""

import argparse
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "build" / "release" / "bin" / "link_study"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True, help="folder; made if it is not there")
    parser.add_argument("--quick", action="store_true", help="two delays, two losses")
    options = parser.parse_args()
    command = [PROGRAM, *(["--quick"] if options.quick else []), options.out]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as program:
        for line in program.stderr:
            if sys.stderr.isatty():
                print(f"\r\033[K{line.strip()}", end="", file=sys.stderr, flush=True)
    if sys.stderr.isatty():
        print(file=sys.stderr)
    return 1 if program.returncode else 0


sys.exit(main())
