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
import json
import math
import os
import statistics
import sys
from dataclasses import dataclass, field
from pathlib import Path

WIDTH_PX, DPI = 1600, 100
ERROR_INCHES, TIMING_INCHES, ROW_INCHES = 3.6, 2.5, 0.27
WIDE_TIMES, WIDE_ERRORS = 10, 30  # largest to median: from here on a logarithmic axis
NEAR = 3           # a deadline this far above the slowest is worth a line
LONGEST_NAME = 60  # characters of a scene in the title
TIME_UNITS = ((3 * 3600, 3600, "h"), (180, 60, "min"), (0, 1, "s"))  # from, in seconds, name

# The colour-blind-safe palette of Okabe and Ito, without its yellow; (colour, line style).
LAW_STYLES = {
    "constant": ("#E69F00", "-"),
    "linear_time": ("#0072B2", "-"),
    "linear_position": ("#D55E00", "-"),
    "linear_position_signed": ("#000000", (0, (2, 1.5))),
}
OTHER_STYLES = (("#009E73", "-"), ("#CC79A7", "-"), ("#56B4E9", "-"), ("#7F7F7F", "-"))
TICK_COLOUR, STEP_COLOUR, SERVER_COLOUR = "#0072B2", "#009E73", "#000000"
MISSED_COLOUR, PERIOD_COLOUR = "#882255", "#7F7F7F"

# Key, heading, decimals.
PAPER_SCORES = (("paper_mean_percent", "average", 3), ("paper_max_percent", "maximal", 1),
                ("paper_max_force_percent", "maximal force", 1))
SCORES = (("mean_percent", "mean, % of RMS", 3), ("p99_percent", "p99, % of peak", 3),
          ("max_percent", "max, % of peak", 2))


class Unusable(Exception):
    """A report or the arguments cannot be used; the text is for the user."""


class Node:
    """A value of a JSON file that knows where it stands."""

    def __init__(self, value, file, path=""):
        self.value, self.file, self.path = value, file, path

    def of(self, kind, name):
        if not isinstance(self.value, kind) or isinstance(self.value, bool):
            raise Unusable(f"{self.file}: {self.path or 'the file'} is not {name}")
        return self.value

    def __contains__(self, key):
        return key in self.of(dict, "an object")

    def __getitem__(self, key):
        path = f"{self.path}.{key}" if self.path else key
        if key not in self:
            raise Unusable(f"{self.file}: missing key {path}")
        return Node(self.value[key], self.file, path)

    def items(self):
        return [Node(value, self.file, f"{self.path}[{i}]")
                for i, value in enumerate(self.of(list, "a list"))]

    def keys(self):
        return list(self.of(dict, "an object"))

    def text(self):
        return self.of(str, "a text")

    def number(self, or_null=False):
        if or_null and self.value is None:
            return math.nan
        try:
            number = float(self.of((int, float), "a number"))
        except OverflowError:
            number = math.inf
        if not math.isfinite(number) or number < 0:
            raise Unusable(f"{self.file}: {self.path} is {number:g}")
        return number


def read_json(path):
    try:
        return Node(json.loads(path.read_text(encoding="utf-8")), path)
    except OSError as error:
        raise Unusable(f"{path}: {error.strerror or error}") from None
    except (ValueError, RecursionError) as error:
        raise Unusable(f"{path}: not JSON: {error}") from None


@dataclass
class Timeline:
    """Cells side by side; {column: [number]}, nan where there is nothing."""
    edges: list  # s, one more than cells
    columns: dict

    @classmethod
    def read(cls, node, columns, counts):
        """`counts`: columns that say together how much of a cell was lived through."""
        width, cells = node["cell_s"].number(), node["cells"].items()
        if width <= 0:
            raise Unusable(f"{node.file}: {node.path}.cell_s is 0")
        read = {name: [cell[name].number() for cell in cells] for name in columns}
        begins = [cell["t_s"].number() for cell in cells]
        if any(after <= before for before, after in zip(begins, begins[1:])):
            raise Unusable(f"{node.file}: {node.path}.cells: t_s does not grow")
        if not cells:
            return cls([], read)
        # The last cell may have been cut short by the end; it must not look like a whole one.
        lived = [sum(parts) for parts in zip(*(read[name] for name in counts))]
        whole = statistics.median(lived[:-1]) if len(lived) > 1 else 0
        share = min(1.0, lived[-1] / whole) if whole > 0 else 1.0
        return cls(begins + [begins[-1] + share * width], read)

    def times(self, name):
        """A duration is never 0: that is nothing measured."""
        return [value if value > 0 else math.nan for value in self.columns[name]]


@dataclass
class Tool:
    """What a picture shows."""
    file: Path
    heading: str
    felt: str
    timeline: Timeline
    errors: dict                 # {law: [% per cell]}
    scores: dict                 # {law: {key: %}}
    rate_hz: float = 0           # 0: not known
    server: Timeline = None
    server_rate_hz: float = 0
    notes: list = field(default_factory=list)


def errors_of(node, laws):
    """{law: [% per cell]}; nan in cells where no law was wrong at all: nothing was scored there."""
    cells = [cell["error_percent"] for cell in node["cells"].items()]
    rows = [[cell[law].number(or_null=True) for law in laws] for cell in cells]
    rows = [row if any(value > 0 for value in row) else [math.nan] * len(laws) for row in rows]
    return {law: [row[i] for row in rows] for i, law in enumerate(laws)}


def read_tools(report, server):
    tools = report["tools"].items()
    if not tools:
        raise Unusable(f"{report.file}: tools is empty")
    return [read_tool(report, server, node, i, len(tools)) for i, node in enumerate(tools)]


def read_tool(report, server, node, index, count):
    method, methods, line = node["method"].text(), node["methods"], node["timeline"]
    laws = methods.keys()
    scores = {law: {key: methods[law][key].number() for key, _, _ in PAPER_SCORES + SCORES}
              for law in laws}
    timeline = Timeline.read(line, ("ticks", "missed", "tick_us_mean", "tick_us_max", "samples",
                                    "step_ms_mean", "step_ms_max"), ("ticks", "missed"))
    if not timeline.edges:
        raise Unusable(f"{report.file}: {line.path}.cells is empty: no session to draw")
    tool = Tool(report.file, "", method, timeline, errors_of(line, laws), scores)
    for place in (node["loop"] if "loop" in node else None,
                  report["capture"] if "capture" in report else None):
        if place and "rate_hz" in place:
            tool.rate_hz = place["rate_hz"].number()
            break

    scene = "replay" if "capture" in report else "session"
    if "server" in report:
        scene += f" with {report['server'].text()}"
    if server:
        tool.server = Timeline.read(server["timeline"], ("steps", "step_ms_mean", "step_ms_max", "late"),
                                    ("steps",))
        tool.server_rate_hz = server["rate_hz"].number()
        scene = server["title"].text() if "title" in server else scene
        if "sessions" in server and server["sessions"].number() > 1:
            tool.notes.append("SERVER.json tells of several sessions; its time begins with the first")
    scene = " ".join(scene.split()) or "session"
    if len(scene) > LONGEST_NAME:
        scene = scene[:LONGEST_NAME - 1] + "\N{HORIZONTAL ELLIPSIS}"
    parts = [scene, f"felt: {method}", f"{tool.rate_hz:g} Hz" if tool.rate_hz else "",
             duration(timeline.edges[-1] - timeline.edges[0]),
             f"tool {index + 1} of {count}" if count > 1 else ""]
    tool.heading = "   \N{MIDDLE DOT}   ".join(part for part in parts if part)
    return tool


def duration(seconds):
    if seconds < 120:
        return f"{seconds:.3g} s"
    minutes = round(seconds / 60)
    if minutes < 120:
        return f"{int(seconds // 60)} min {int(seconds % 60)} s"
    return f"{minutes // 60} h {minutes % 60} min"


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


def style_of_laws(laws):
    others = iter(OTHER_STYLES * len(laws))
    return {law: LAW_STYLES.get(law) or next(others) for law in laws}


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
    for ends, scores, heading in (((0.41, 0.51, 0.63), PAPER_SCORES, "paper: % of the interpolated force"),
                                  ((0.77, 0.885, 1.0), SCORES, "error of the force")):
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
        axis.text(0.04, row + 0.5, f"{law} (felt)" if felt else law, weight=weight, **size)
        for x, key, _, decimals in columns:
            value = scores[key]
            axis.text(x, row + 0.5, f"{value:.{decimals}f}" if value < 1e6 else f"{value:.2e}", ha="right",
                      weight=weight, **size)


def draw(tool):
    """Return the picture, as the bytes of a PNG."""
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
    figure.suptitle(tool.heading, fontsize=16, weight="bold")
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
    picture = io.BytesIO()
    figure.savefig(picture, format="png", dpi=DPI, facecolor="white")
    pyplot.close(figure)
    return picture.getvalue()


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
    arguments = parser.parse_args()

    try:
        output = arguments.output
        if output.suffix != ".png":
            raise Unusable(f"{output}: the name must end in .png")
        tools = read_tools(read_json(arguments.report),
                           read_json(arguments.server) if arguments.server else None)
        write_all({output.with_stem(output.stem + (f"-{i}" if i > 1 else "")): draw(tool)
                   for i, tool in enumerate(tools, 1)})
    except Unusable as problem:
        print(f"session.py: {problem}", file=sys.stderr)
        return 2
    except ImportError:
        print("session.py: matplotlib is missing: apt-get install python3-matplotlib", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
