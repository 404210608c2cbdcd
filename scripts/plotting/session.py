#!/usr/bin/python3
"""Draw a session, seconds or hours long, so that it shows whether it degrades.

REPORT.json is what haptic_client wrote with --report. From top to bottom, against
time: the error of each scored law; the time of a haptic tick, with the ticks it
missed; the time of a step of the server, as its samples tell. Below them the scores
of the whole session. What a report has no figures of (a replay has no tick times) is
left out. One picture per tool: OUT.png, OUT-2.png, ... Needs Debian's
python3-matplotlib.

example: scripts/plotting/session.py out/report.json out/session.png --server out/server.json

Exit status: 0 drawn, 2 a report or the arguments cannot be used, nothing is written.
"""

import argparse
import io
import math
import os
import statistics
import sys
from pathlib import Path

from pictures import add_format, files_of, style_of_laws
from session_report import PAPER_SCORES, SCORES, Unusable, read_json, read_tools

WIDTH_PX, DPI = 1600, 100
ERROR_INCHES, TIMING_INCHES, ROW_INCHES = 3.6, 2.5, 0.27
WIDE_TIMES, WIDE_ERRORS = 10, 30  # largest to median: from here on a logarithmic axis
NEAR = 3           # a deadline this far above the slowest is worth a line
TIME_UNITS = ((3 * 3600, 3600, "h"), (180, 60, "min"), (0, 1, "s"))  # from, in seconds, name

TICK_COLOUR, STEP_COLOUR, SERVER_COLOUR = "#0072B2", "#009E73", "#000000"
MISSED_COLOUR, PERIOD_COLOUR = "#882255", "#7F7F7F"


def nan_free(*series):
    return [value for values in series for value in values if not math.isnan(value)]


def scale_axis(axis, wide, typical, *others):
    """From 0, or logarithmic where the largest is so far above the typical that it would press them flat."""
    from matplotlib import ticker
    values = [value for value in nan_free(typical, *others) if value > 0]
    if not values:
        return
    low, high = min(values), max(values)
    if high < wide * statistics.median(nan_free(typical) or values):
        axis.set_ylim(0, 1.12 * high)
        return
    axis.set_yscale("log")
    axis.set_ylim(low / 1.3, 1.5 * high)
    decades = math.log10(high / low)
    axis.yaxis.set_major_locator(
        ticker.LogLocator(subs=(1, 2, 5) if decades < 1.5 else (1, 3) if decades < 2.5 else (1,)))
    axis.yaxis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:.10g}"))
    axis.yaxis.set_minor_formatter(ticker.NullFormatter())


def draw_errors(axis, tool, unit, styles):
    edges = [edge / unit for edge in tool.timeline.edges]
    for law, values in tool.errors.items():
        colour, line = styles[law]
        felt = law == tool.felt
        # The felt law is wide and below, so that a law that coincides with it is seen on it.
        axis.stairs(values, edges, baseline=None, color=colour, linestyle="-" if felt else line,
                    linewidth=4.5 if felt else 1.5, zorder=2 if felt else 3,
                    label=f"{law} (felt)" if felt else law)
    gaps = any(math.isnan(value) for values in tool.errors.values() for value in values)
    axis.set_title("Error of the laws" + (" (gaps: no contact or no samples)" if gaps else ""), loc="left")
    axis.set_ylabel("% of RMS force")
    scale_axis(axis, WIDE_ERRORS, nan_free(*tool.errors.values()))


def draw_times(axis, timeline, unit, mean, highest, colour, name, line="-"):
    edges = [edge / unit for edge in timeline.edges]
    means, maxima = timeline.times(mean), timeline.times(highest)
    axis.stairs(means, edges, baseline=None, color=colour, linewidth=2.4, linestyle=line, label=f"{name}mean")
    axis.stairs(maxima, edges, baseline=None, color=colour, linewidth=1, linestyle=line, label=f"{name}max")
    return means, maxima


def draw_counts(axis, timeline, unit, counts, name):
    """Deadlines not kept: bars on an axis of their own, and a mark in each cell with any, be they ever so few."""
    from matplotlib import ticker
    values = timeline.columns[counts]
    if not any(values):
        return
    edges = [edge / unit for edge in timeline.edges]
    bars = axis.twinx()
    bars.bar(edges[:-1], values, [end - begin for begin, end in zip(edges, edges[1:])], align="edge",
             color=MISSED_COLOUR, alpha=0.25, linewidth=0)
    bars.set_ylim(0, 1.12 * max(values))
    bars.yaxis.set_major_locator(ticker.MaxNLocator(4, integer=True))
    bars.set_ylabel(f"{name}", color=MISSED_COLOUR)
    bars.tick_params(axis="y", colors=MISSED_COLOUR)
    axis.set_zorder(bars.get_zorder() + 1)
    axis.patch.set_visible(False)
    marked = [(begin + end) / 2 for begin, end, value in zip(edges, edges[1:], values) if value]
    axis.plot(marked, [0.035] * len(marked), "^", transform=axis.get_xaxis_transform(), markersize=6,
              color=MISSED_COLOUR, label=f"{name}: {sum(values):.0f}", zorder=4)


def draw_period(axis, rate_hz, per_second, values):
    """The time there is, if what was needed comes near it."""
    if rate_hz <= 0 or not values:
        return []
    period = per_second / rate_hz
    if period > NEAR * max(values):
        return []
    axis.axhline(period, color=PERIOD_COLOUR, linestyle=":", linewidth=1.5, label="period", zorder=1)
    return [period]


def draw_ticks(axis, tool, unit):
    means, maxima = draw_times(axis, tool.timeline, unit, "tick_us_mean", "tick_us_max", TICK_COLOUR, "")
    period = draw_period(axis, tool.rate_hz, 1e6, nan_free(maxima))
    draw_counts(axis, tool.timeline, unit, "missed", "missed ticks")
    axis.set_title("Haptic tick", loc="left")
    axis.set_ylabel("time (\N{MICRO SIGN}s)")
    scale_axis(axis, WIDE_TIMES, means, maxima, period)


def draw_steps(axis, tool, unit):
    series = []
    if tool.server and tool.server.edges:
        series += draw_times(axis, tool.server, unit, "step_ms_mean", "step_ms_max", SERVER_COLOUR, "every step: ")
    if nan_free(tool.timeline.times("step_ms_max")):
        series += draw_times(axis, tool.timeline, unit, "step_ms_mean", "step_ms_max", STEP_COLOUR,
                             "those with a sample: " if series else "", (0, (4, 1.5)) if series else "-")
    if tool.server and tool.server.edges:
        series.append(draw_period(axis, tool.server_rate_hz, 1e3, nan_free(*series)))
        draw_counts(axis, tool.server, unit, "late", "late deadlines")
    axis.set_title("Step of the server", loc="left")
    axis.set_ylabel("time (ms)")
    scale_axis(axis, WIDE_TIMES, *series)


def draw_scores(axis, tool, styles):
    """A table: a row per law, in the colours of the lines above."""
    rows = len(tool.scores) + 2
    axis.set(xlim=(0, 1), ylim=(rows, 0))
    axis.axis("off")
    size = {"fontsize": 12, "va": "center"}
    grey = {"color": "#555555", **size}
    columns = []
    against = f"error of the force, against: {tool.reference}" if tool.reference else "error of the force"
    for ends, scores, heading in (((0.41, 0.51, 0.63), PAPER_SCORES, "paper: % of the force on the line"),
                                  ((0.77, 0.885, 1.0), SCORES, against)):
        begin = ends[0] - 0.09
        axis.text((begin + ends[-1]) / 2, 0.4, heading, ha="center", **grey)
        axis.plot((begin, ends[-1]), (0.95, 0.95), color="#BBBBBB", linewidth=0.8)
        columns += [(x, *score) for x, score in zip(ends, scores)]
    axis.text(0, 1.5, "whole session", **grey)
    for x, _, name, _ in columns:
        axis.text(x, 1.5, name, ha="right", **grey)
    axis.plot((0, 1), (2, 2), color="#555555", linewidth=0.8)
    for row, (law, scores) in enumerate(tool.scores.items(), 2):
        felt = law == tool.felt
        colour, line = styles[law]
        weight = "bold" if felt else "normal"
        axis.plot((0.003, 0.03), (row + 0.5, row + 0.5), color=colour, linestyle="-" if felt else line,
                  linewidth=4.5 if felt else 1.5, solid_capstyle="butt")
        axis.text(0.04, row + 0.5, f"{tool.names[law]}, felt" if felt else tool.names[law], weight=weight, **size)
        for x, key, _, decimals in columns:
            value = scores[key]
            text = "-" if math.isnan(value) else f"{value:.{decimals}f}" if value < 1e6 else f"{value:.2e}"
            axis.text(x, row + 0.5, text, ha="right", weight=weight, **size)


def draw(tool, paths):
    """{path: bytes}, each in the format that its name ends in."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot

    pyplot.rcParams.update({"font.size": 13, "axes.spines.top": False, "axes.spines.right": False,
                            "axes.axisbelow": True, "text.parse_math": False})
    timeline, server = tool.timeline, tool.server
    panels = []
    if any(nan_free(values) for values in tool.errors.values()):
        panels.append((draw_errors, ERROR_INCHES))
    elif tool.errors:
        tool.notes.append("no contact was scored")
    if nan_free(timeline.times("tick_us_max")):
        panels.append((draw_ticks, TIMING_INCHES))
    if nan_free(timeline.times("step_ms_max")) or server and nan_free(server.times("step_ms_max")):
        panels.append((draw_steps, TIMING_INCHES))
    if not panels:
        raise Unusable(f"{tool.file}: nothing to draw: no contact was scored and no time was measured")
    heights = [height for _, height in panels]
    if tool.scores:
        heights.append(ROW_INCHES * (len(tool.scores) + 2))

    figure, axes = pyplot.subplots(len(heights), 1, figsize=(WIDTH_PX / DPI, sum(heights) + 1.2), dpi=DPI,
                                   facecolor="white", height_ratios=heights, layout="constrained", squeeze=False)
    axes = [row[0] for row in axes]
    figure.get_layout_engine().set(w_pad=0.12, h_pad=0.08)
    lines = (tool.heading, *tool.error.split("   ", 1))
    figure.suptitle("\n".join(line for line in lines if line), fontsize=14, weight="bold")
    end = max(timeline.edges[-1], server.edges[-1] if server and server.edges else 0)
    unit, name = next((unit, name) for begin, unit, name in TIME_UNITS if end >= begin)
    styles = style_of_laws(tool.errors)
    for (panel, _), axis in zip(panels, axes):
        panel(axis, tool, unit, styles) if panel is draw_errors else panel(axis, tool, unit)
        axis.set_xlim(0, end / unit)
        axis.xaxis.set_major_locator(pyplot.MaxNLocator(10, steps=(1, 2, 5, 10)))
        axis.grid(alpha=0.3)
        handles, _ = axis.get_legend_handles_labels()
        axis.legend(loc="lower right", bbox_to_anchor=(1, 1), ncols=len(handles) if len(handles) < 7 else 4,
                    frameon=False, fontsize=11, borderpad=0.1, borderaxespad=0.2, columnspacing=1.4)
    for axis in axes[:len(panels) - 1]:
        axis.tick_params(labelbottom=False)
    axes[len(panels) - 1].set_xlabel(f"time ({name})" + "".join(f"   [{note}]" for note in tool.notes))
    if tool.scores:
        draw_scores(axes[-1], tool, styles)
    pictures = {}
    for path in paths:
        picture = io.BytesIO()
        figure.savefig(picture, format=path.suffix[1:], dpi=DPI, facecolor="white")
        pictures[path] = picture.getvalue()
    pyplot.close(figure)
    return pictures


def write_all(pictures):
    """Write every {path: bytes}, whole, or none of them."""
    drafts = {path: path.with_name(f".{path.name}.{os.getpid()}") for path in pictures}
    try:
        for path, picture in pictures.items():
            if path.is_dir():
                raise Unusable(f"{path}: is a directory")
            try:
                drafts[path].write_bytes(picture)
            except OSError as error:
                raise Unusable(f"{path}: {error.strerror or error}") from None
        for path, draft in drafts.items():
            try:
                draft.replace(path)
            except OSError as error:
                raise Unusable(f"{path}: {error.strerror or error}") from None
    finally:
        for draft in drafts.values():
            try:
                draft.unlink(missing_ok=True)
            except OSError:
                pass  # where a draft could not be written


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("report", type=Path, metavar="REPORT.json")
    parser.add_argument("output", type=Path, metavar="OUT.png")
    parser.add_argument("--server", type=Path, metavar="SERVER.json",
                        help="report of the sim_server: its title, every step, late deadlines")
    add_format(parser)
    arguments = parser.parse_args()

    try:
        output = arguments.output
        if output.suffix != ".png":
            raise Unusable(f"{output}: the name must end in .png")
        tools = read_tools(read_json(arguments.report),
                           read_json(arguments.server) if arguments.server else None)
        pictures = {}
        for i, tool in enumerate(tools, 1):
            png = output.with_stem(output.stem + (f"-{i}" if i > 1 else ""))
            pictures |= draw(tool, files_of(png, arguments.plot_format))
        write_all(pictures)
    except Unusable as problem:
        print(f"session.py: {problem}", file=sys.stderr)
        return 2
    except ImportError:
        print("session.py: matplotlib is missing: apt-get install python3-matplotlib", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
