#!/usr/bin/python3
"""Draw the force of a haptic trace: the first contact after the soft start, and by how much each law is off between two samples.

TRACE.csv has a row per tick of the haptic client, with the columns t_s, fx_n, fy_n,
fz_n (the force given to the hand), sample_t_s, sample_n (filled only where a force
computed by the simulation arrived) and one <law>_n per way of filling the gap between
two samples. From top to bottom: the whole trace; its first contact, with the samples
as impulses; extrapolated minus reference, where the reference is a monotone cubic
through the samples' |F| (Fritsch and Carlson 1980). Laws that lie within 0.5 % of the
largest force of each other are drawn as one, named together. Needs Debian's
python3-matplotlib.

example: scripts/plotting/force.py out/trace.csv out/force.png --report out/report.json --server out/server.json

Exit status: 0 drawn, 2 the trace or the arguments cannot be used.
"""

import argparse
import csv
import math
import statistics
import sys
from bisect import bisect_right
from pathlib import Path

from pictures import CannotSave, add_format, in_words, prepare, save, style_of_laws
from session_report import Unusable, at_work, error_of, read_json, share_text

WIDTH_PX, HEIGHT_PX, DPI = 1600, 1150, 100
NEEDED = ("t_s", "fx_n", "fy_n", "fz_n", "sample_t_s", "sample_n")
NOT_LAWS = ("fx_n", "fy_n", "fz_n", "sample_n", "reference_n", "extrapolation_n", "error_n")
BEFORE, AFTER = 0.03, 0.05    # s around the first contact
LONGEST, SHORTEST = 2.0, 0.3  # s of it that are shown
CLEAR_SHARE = 0.2             # of the largest force: that much is clearly a contact
SOFT_START = 1.0              # s from the first sample on, in which the client lets the force rise
TOUCH_SHARE = 0.01            # of the largest force: less than that is no contact
SAME_SHARE = 0.005            # of the largest force: laws this near to each other look like one
WELL_SEEN = 0.08              # of the largest error: an error below it needs a scale of its own
SAMPLE_COLOUR, HAND_COLOUR = "#000000", "#BBBBBB"


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
    """[(time of the tool's pose, |F|)], by time, each time once."""
    found = {time: force for time, force in zip(trace["sample_t_s"], trace["sample_n"])
             if not math.isnan(time) and not math.isnan(force)}
    return sorted(found.items())


def delay_of(trace):
    """Median time (s) from a pose to the arrival of its force; None without samples."""
    late = [arrived - time for arrived, time in zip(trace["t_s"], trace["sample_t_s"]) if not math.isnan(time)]
    return statistics.median(late) if late else None


def end_of_soft_start(trace):
    """When the force has risen; the start of a trace that has no sample, or begins later."""
    moments = [time for time, arrived in zip(trace["t_s"], trace["sample_t_s"]) if not math.isnan(arrived)]
    begins = trace.get("sample", [1])[0] in (0, 1)
    return moments[0] + SOFT_START if moments and begins else trace["t_s"][0]


def first_contact_window(times, forces, risen):
    """From just before the force first rises to a clear contact until it is gone again, or LONGEST; of the contacts
    that begin after `risen` (s), if one does."""
    largest = max((force for force in forces if not math.isnan(force)), default=0.0)
    if largest == 0:
        return times[0], min(times[-1], times[0] + LONGEST)
    touch = TOUCH_SHARE * largest
    free = next((i for i, time in enumerate(times) if time >= risen and forces[i] <= touch), 0)
    clear = [i for i, force in enumerate(forces) if force >= CLEAR_SHARE * largest]
    moment = next((i for i in clear if i >= free), clear[0])
    first = moment
    while first > 0 and forces[first - 1] > touch:
        first -= 1
    last = next((i for i in range(moment, len(forces)) if forces[i] <= touch), len(forces) - 1)
    begin = max(times[0], times[first] - BEFORE)
    end = min(times[last] + AFTER, begin + LONGEST)
    return begin, min(times[-1], max(end, begin + SHORTEST))


def slopes_of(samples):
    """Of a monotone cubic through (t, y): Fritsch and Carlson (1980), with their harmonic mean."""
    steps = [(b[0] - a[0], (b[1] - a[1]) / (b[0] - a[0])) for a, b in zip(samples, samples[1:])]
    slopes = [0.0] * len(samples)
    for i, ((h, d), (g, e)) in enumerate(zip(steps, steps[1:]), 1):
        if d * e > 0:
            slopes[i] = 3 * (h + g) / ((2 * g + h) / d + (g + 2 * h) / e)
    if steps:
        slopes[0], slopes[-1] = steps[0][1], steps[-1][1]
    return slopes


def reference_at(times, samples):
    """|F| of the curve through the samples at each time; nan outside them."""
    moments, slopes = [time for time, _ in samples], slopes_of(samples)
    values = []
    for time in times:
        i = bisect_right(moments, time) - 1
        if i < 0 or i + 1 >= len(samples):
            values.append(math.nan)
            continue
        (a, y), (b, z) = samples[i:i + 2]
        h, s = b - a, (time - a) / (b - a)
        values.append(y * (1 + 2 * s) * (1 - s) ** 2 + h * slopes[i] * s * (1 - s) ** 2
                      + z * s * s * (3 - 2 * s) + h * slopes[i + 1] * s * s * (s - 1))
    return values


def laws_of(trace):
    return [name.removesuffix("_n") for name in trace if name.endswith("_n") and name not in NOT_LAWS]


def apart(a, b):
    return max((abs(x - y) for x, y in zip(a, b) if not math.isnan(x - y)), default=0.0)


def groups_of(lines, largest):
    """[[law, ...]]: laws whose lines cannot be told apart; the first of each group stands for it."""
    groups = []
    for law, line in lines.items():
        mates = next((g for g in groups if apart(lines[g[0]], line) <= SAME_SHARE * largest), None)
        if mates:
            mates.append(law)
        else:
            groups.append([law])
    return groups


def heading_of(trace, report, server, tool):
    """What was touched, felt, at which rate and delay; of what is known."""
    parts, error = [], ""
    if server and "title" in server:
        parts.append(server["title"].text())
    rate = None
    if report:
        tools = report["tools"].items()
        if not 1 <= tool <= len(tools):
            raise Unusable(f"{report.file}: has no tool {tool}, it has {len(tools)}")
        node = tools[tool - 1]
        found = at_work(node["rendered"]) if "rendered" in node else None
        if found:
            parts.append(f"rendered: {in_words(found[0])}, {share_text(found[1])} of the time")
        if len(tools) > 1:
            parts.append(f"tool {tool} of {len(tools)}")
        error = error_of(node)
    if server:
        rate = server["rate_hz"].number()
    samples = samples_of(trace)
    if not rate and len(samples) > 1:
        rate = 1 / statistics.median(b[0] - a[0] for a, b in zip(samples, samples[1:]))
    if rate:
        parts.append(f"server {rate:.3g} Hz")
    delay = delay_of(trace)
    if delay is not None:
        parts.append(f"delay {1000 * delay:.3g} ms (computation and link)")
    heading = "   \N{MIDDLE DOT}   ".join(parts) or "Force on the hand"
    return f"{heading}\n{error}" if error else heading


def draw_whole(axes, times, forces, window, risen):
    axes.plot(times, forces, color="#333333", linewidth=1)
    axes.axvspan(*window, color="#56B4E9", alpha=0.35, linewidth=0)
    note = ""
    if risen > times[0]:
        axes.axvspan(times[0], risen, facecolor="none", edgecolor="#999999", hatch="//", linewidth=0)
        note = "; hatched: soft start"
    axes.set_title(f"Force on the hand, the whole trace (shaded: shown below{note})", loc="left")
    axes.set(ylabel="|F| (N)", xlim=(times[0], times[-1]))
    axes.set_ylim(bottom=0)
    axes.grid(alpha=0.3)


def draw_laws(axes, times, lines, groups, styles, hand, near, after):
    axes.plot(times, hand, color=HAND_COLOUR, linewidth=6, solid_capstyle="butt", label="given to the hand")
    for group in groups:
        colour, line = styles[group[0]]
        axes.plot(times, lines[group[0]], color=colour, linestyle=line, linewidth=1.8,
                  drawstyle="steps-post" if group[0] == "constant" else "default", label=name_of(group))
    if near:
        stems = axes.stem(*zip(*near), basefmt=" ", label="computed by the simulation")
        stems.stemlines.set(color=SAMPLE_COLOUR, linewidth=0.8, alpha=0.35)
        stems.markerline.set(color=SAMPLE_COLOUR, markersize=4.5, zorder=5)
    axes.set_title(f"The first contact{after}: impulses are what the simulation computed, lines what fills the gaps", loc="left")
    axes.set(ylabel="|F| (N)")
    top = max([*(v for line in lines.values() for v in line if not math.isnan(v)), *hand, 0])
    axes.set_ylim(0, 1.05 * top if top > 0 else 1)


def name_of(group):
    return " = ".join(in_words(law) for law in group)


def draw_errors(axes, times, lines, groups, styles, reference):
    """Signed; where one law is much better than another, on a scale that shows both."""
    sizes = []
    for group in groups:
        off = [1000 * (a - b) for a, b in zip(lines[group[0]], reference)]
        known = [abs(x) for x in off if not math.isnan(x)]
        if not known:
            continue
        sizes.append(statistics.fmean(known))
        colour, line = styles[group[0]]
        axes.plot(times, off, color=colour, linestyle=line, linewidth=1.3,
                  label=f"{name_of(group)}: {sizes[-1]:.2g} mN on average")
    axes.axhline(0, color="#555555", linewidth=0.8)
    axes.set_title("Its error: extrapolated minus reference, a monotone cubic through the samples", loc="left")
    if sizes and 0 < min(sizes) < WELL_SEEN * max(sizes):
        axes.set_yscale("symlog", linthresh=10 ** math.ceil(math.log10(min(sizes))), linscale=0.8)
        axes.yaxis.set_major_formatter("{x:g}")
        axes.set_ylabel("error of |F| (mN),\nlogarithmic outwards")
    else:
        axes.set_ylabel("error of |F| (mN)")


def draw(trace, window, heading):
    pyplot = prepare(**{"font.size": 13})
    times, forces, samples = trace["t_s"], norm_of_force(trace), samples_of(trace)
    begin, end = window
    figure, (whole, zoom, error) = pyplot.subplots(
        3, 1, figsize=(WIDTH_PX / DPI, HEIGHT_PX / DPI), dpi=DPI, facecolor="white",
        height_ratios=(1, 3, 2.4), layout="constrained")
    figure.get_layout_engine().set(w_pad=0.12, h_pad=0.1)
    heading, _, off = heading.partition("\n")
    figure.suptitle(heading, fontsize=15, weight="bold")
    if off:
        whole.text(0.5, 1.35, off, transform=whole.transAxes, fontsize=11, ha="center")
    risen = end_of_soft_start(trace)
    draw_whole(whole, times, forces, window, risen)

    # A tick to either side, so that lines reach the edges of the panel.
    inside = [i for i, time in enumerate(times) if begin <= time <= end]
    ticks = slice(max(0, inside[0] - 1), inside[-1] + 2)
    lines = {law: trace[f"{law}_n"][ticks] for law in laws_of(trace)}
    near = [(time, force) for time, force in samples if begin <= time <= end]
    groups, styles = groups_of(lines, max(forces, default=0)), style_of_laws(lines)
    draw_laws(zoom, times[ticks], lines, groups, styles, forces[ticks], near,
              " after the soft start" if times[0] < risen <= begin else "")
    draw_errors(error, times[ticks], lines, groups, styles, reference_at(times[ticks], samples))
    for axes in (zoom, error):
        axes.set_xlim(begin, end)
        axes.grid(alpha=0.3)
        if axes.get_legend_handles_labels()[0]:
            axes.legend(loc="upper left", bbox_to_anchor=(1.005, 1.02), frameon=False, fontsize=11,
                        borderaxespad=0, labelspacing=0.8)
    for texts in (a.get_legend().get_texts() for a in (zoom, error) if a.get_legend()):
        for text in texts:
            text.set_text(text.get_text().replace(" = ", "\n= ").replace(": ", ":\n"))
    zoom.tick_params(labelbottom=False)
    error.set_xlabel("time (s)")
    return figure


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("trace", type=Path, metavar="TRACE.csv")
    parser.add_argument("output", type=Path, metavar="OUT.png")
    parser.add_argument("--seconds", type=float, nargs=2, metavar=("A", "B"),
                        help="what the lower panels show, in the trace's time (default: the first contact)")
    parser.add_argument("--report", type=Path, metavar="REPORT.json",
                        help="report of the haptic_client: which law was felt")
    parser.add_argument("--server", type=Path, metavar="SERVER.json",
                        help="report of the sim_server: title of the scene, rate")
    parser.add_argument("--tool", type=int, default=1, help="which tool of the report this trace is of (1)")
    add_format(parser)
    arguments = parser.parse_args()

    try:
        if arguments.output.suffix != ".png":
            raise Unusable(f"{arguments.output}: the name must end in .png")
        trace = read_trace(arguments.trace)
        times = trace["t_s"]
        window = arguments.seconds or first_contact_window(times, norm_of_force(trace), end_of_soft_start(trace))
        if not any(window[0] <= time <= window[1] for time in times):
            raise Unusable(f"--seconds {window[0]:g} {window[1]:g}: nothing there, "
                           f"the trace goes from {times[0]:g} to {times[-1]:g}")
        heading = heading_of(trace, read_json(arguments.report) if arguments.report else None,
                             read_json(arguments.server) if arguments.server else None, arguments.tool)
        save(draw(trace, window, heading), arguments.output, arguments.plot_format, DPI)
    except (Unusable, CannotSave) as problem:
        print(f"force.py: {problem}", file=sys.stderr)
        return 2
    except ImportError:
        print("force.py: matplotlib is missing: apt-get install python3-matplotlib",
              file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
