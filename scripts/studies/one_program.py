"""A study that one program does: its command line, its progress on one line, its exit code."""

import argparse
import subprocess
import sys
from pathlib import Path

BIN = Path(__file__).resolve().parents[2] / "build" / "release" / "bin"


def main(program, text, quick):
    """`text`: the study's own help; `quick`: what --quick leaves out."""
    parser = argparse.ArgumentParser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True, help="folder; made if it is not there")
    parser.add_argument("--quick", action="store_true", help=quick)
    options = parser.parse_args()
    command = [BIN / program, *(["--quick"] if options.quick else []), options.out]
    last = ""
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as running:
        for last in running.stderr:
            if sys.stderr.isatty():
                print(f"\r\033[K{last.strip()}", end="", file=sys.stderr, flush=True)
    if sys.stderr.isatty():
        print(file=sys.stderr)
    elif running.returncode:
        print(last.strip(), file=sys.stderr)
    return 1 if running.returncode else 0
