"""Whether the forces that a program rendered are those that `haptic_client replay` makes of the server's capture.

usage: same_forces.py RENDERED.csv REPLAYED.csv
"""
import csv
import sys


def forces(file):
    with open(file, newline="") as f:
        return {int(row["tick"]): [float(row[k]) for k in ("fx_n", "fy_n", "fz_n")] for row in csv.DictReader(f)}


def main():
    rendered, replayed = (forces(file) for file in sys.argv[1:])
    assert len(replayed) > 0.98 * len(rendered), (len(rendered), len(replayed))
    other = [tick for tick, force in replayed.items() if force != rendered[tick]]
    assert not other, f"{len(other)} of {len(replayed)} ticks rendered another force, the first is {other[0]}"
    pushed = sum(any(force) for force in replayed.values())
    assert pushed > 500, pushed
    print(f"same_forces: {len(replayed)} ticks, {pushed} with a force, each the same as in the replay")


main()
