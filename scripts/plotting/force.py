#!/usr/bin/python3
"""Draw the force of a haptic trace: the whole of it, and between two simulation samples.

TRACE.csv has a row per tick of the haptic client, with the columns t_s, fx_n, fy_n,
fz_n (the force given to the hand), sample_t_s, sample_n (filled only where a force
computed by the simulation arrived) and one <law>_n per way of filling the gap between
two samples. Upper panel: the force against time. Lower panel: a close look, by default
around the first clear contact. Needs Debian's python3-matplotlib.

Exit status: 0 drawn, 2 the trace or the arguments cannot be used.
"""

import argparse
import csv
import math
import sys
from pathlib import Path

WIDTH_PX, HEIGHT_PX, DPI = 1600, 1000, 100
NEEDED = ("t_s", "fx_n", "fy_n", "fz_n", "sample_t_s", "sample_n")
NOT_LAWS = ("fx_n", "fy_n", "fz_n", "sample_n")
ZOOM_SECONDS = (-0.15, 0.45)  # around the first clear contact
CLEAR_SHARE = 0.2             # of the largest force: that much is clearly a contact
TOUCH_SHARE = 0.01            # of the largest force: less than that is no contact

# The colour-blind-safe palette of Okabe and Ito, without its yellow; (colour, line style).
LAW_STYLES = {
    "constant": ("#E69F00", "-"),
    "linear_time": ("#0072B2", "-"),
    "linear_position": ("#D55E00", "--"),
}
OTHER_COLOURS = ("#009E73", "#CC79A7", "#56B4E9", "#7F7F7F")
SAMPLE_COLOUR = "#000000"


class Unusable(Exception):
    """The trace or the arguments cannot be used; the text is for the user."""


def read_trace(path):
    """Return {column: [number]}; an empty field is nan."""
    try:
        with open(path, newline="", encoding="utf-8") as file:
            rows = csv.reader(line for line in file if not line.startswith("#"))
            header = [name.strip() for name in next(rows, [])]
            if not header:
                raise Unusable(f"{path}: the file is empty")
            missing = [name for name in NEEDED if name not in header]
            if missing:
                raise Unusable(f"{path}: missing column {', '.join(missing)}")
            columns = {name: [] for name in header}
            for number, row in enumerate(rows, 1):
                if not row:
                    continue
                if len(row) != len(header):
                    raise Unusable(f"{path}: data row {number} has {len(row)} fields, "
                                   f"the header has {len(header)}")
                for name, field in zip(header, row):
                    try:
                        columns[name].append(float(field) if field.strip() else math.nan)
                    except ValueError:
                        raise Unusable(f"{path}: data row {number}, {name}: "
                                       f"{field!r} is not a number") from None
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise Unusable(f"{path}: {getattr(error, 'strerror', None) or error}") from None
    if len(columns["t_s"]) < 2:
        raise Unusable(f"{path}: fewer than two rows of data")
    if any(math.isnan(time) for time in columns["t_s"]):
        raise Unusable(f"{path}: a row without t_s")
    return columns


def norm_of_force(trace):
    return [math.sqrt(x * x + y * y + z * z)
            for x, y, z in zip(trace["fx_n"], trace["fy_n"], trace["fz_n"])]


def samples_of(trace):
    return [(time, force) for time, force in zip(trace["sample_t_s"], trace["sample_n"])
            if not math.isnan(time) and not math.isnan(force)]


def first_contact_window(times, forces):
    """The seconds around the moment from which the force rises to a clear contact."""
    largest = max((force for force in forces if not math.isnan(force)), default=0.0)
    if largest == 0:
        return times[0], min(times[-1], times[0] + ZOOM_SECONDS[1] - ZOOM_SECONDS[0])
    moment = next(i for i, force in enumerate(forces) if force >= CLEAR_SHARE * largest)
    while moment > 0 and forces[moment - 1] > TOUCH_SHARE * largest:
        moment -= 1
    begin = max(times[0], times[moment] + ZOOM_SECONDS[0])
    return begin, begin + ZOOM_SECONDS[1] - ZOOM_SECONDS[0]


def draw(trace, window, output):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot

    pyplot.rcParams.update({"font.size": 13, "axes.spines.top": False,
                            "axes.spines.right": False, "axes.axisbelow": True})
    times, forces, samples = trace["t_s"], norm_of_force(trace), samples_of(trace)
    begin, end = window
    figure, (whole, zoom) = pyplot.subplots(
        2, 1, figsize=(WIDTH_PX / DPI, HEIGHT_PX / DPI), dpi=DPI, facecolor="white",
        height_ratios=(2, 3), layout="constrained")

    whole.plot(times, forces, color="#333333", linewidth=1)
    whole.axvspan(begin, end, color="#56B4E9", alpha=0.35, linewidth=0)
    whole.annotate("shown below", (end, 1), xycoords=("data", "axes fraction"),
                   xytext=(4, -2), textcoords="offset points", va="top", fontsize=11,
                   color="#0072B2")
    whole.set(title="Force on the hand", ylabel="|F| (N)", xlabel="time (s)",
              xlim=(times[0], times[-1]))
    whole.set_ylim(bottom=0)
    whole.grid(alpha=0.3)

    # A tick to either side, so that lines reach the edges of the panel.
    inside = [i for i, time in enumerate(times) if begin <= time <= end]
    ticks = slice(max(0, inside[0] - 1), inside[-1] + 2)
    others = iter(OTHER_COLOURS * len(trace))
    laws = [name for name in trace if name.endswith("_n") and name not in NOT_LAWS]
    for name in laws:
        law = name.removesuffix("_n")
        colour, line = LAW_STYLES.get(law) or (next(others), "-.")
        zoom.plot(times[ticks], trace[name][ticks], line, color=colour, linewidth=2.2,
                  drawstyle="steps-post" if law == "constant" else "default",
                  label=law.replace("_", " in ") if law.startswith("linear_") else
                  law.replace("_", " "))
    near = [(time, force) for time, force in samples if begin <= time <= end]
    if near:
        stems = zoom.stem(*zip(*near), basefmt=" ", label="computed by the simulation")
        stems.stemlines.set(color=SAMPLE_COLOUR, linewidth=1, alpha=0.6)
        stems.markerline.set(color=SAMPLE_COLOUR, markersize=6)
        stems.markerline.set_zorder(5)
    zoom.set(title="Force between two simulation samples", xlabel="time (s)",
             ylabel="|F| (N)", xlim=(begin, end))
    zoom.set_ylim(bottom=0)
    zoom.grid(alpha=0.3)
    if zoom.get_legend_handles_labels()[0]:
        zoom.legend(loc="upper left", framealpha=0.9)
    try:
        figure.savefig(output, dpi=DPI, facecolor="white")
    except (OSError, ValueError) as error:
        raise Unusable(f"{output}: {getattr(error, 'strerror', None) or error}") from None


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("trace", type=Path, metavar="TRACE.csv")
    parser.add_argument("output", type=Path, metavar="OUT.png")
    parser.add_argument("--seconds", type=float, nargs=2, metavar=("A", "B"),
                        help="what the lower panel shows, in the trace's time")
    arguments = parser.parse_args()

    try:
        trace = read_trace(arguments.trace)
        times = trace["t_s"]
        window = arguments.seconds or first_contact_window(times, norm_of_force(trace))
        if not any(window[0] <= time <= window[1] for time in times):
            raise Unusable(f"--seconds {window[0]:g} {window[1]:g}: nothing there, "
                           f"the trace goes from {times[0]:g} to {times[-1]:g}")
        draw(trace, window, arguments.output)
    except Unusable as problem:
        print(f"force.py: {problem}", file=sys.stderr)
        return 2
    except ImportError:
        print("force.py: matplotlib is missing: apt-get install python3-matplotlib",
              file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
