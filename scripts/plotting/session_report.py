"""Reads a report of haptic_client, and one of sim_server, for session.py; says where one is wrong."""

import json
import math
import statistics
from dataclasses import dataclass, field
from pathlib import Path

LONGEST_NAME = 60  # characters of a scene in the title

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
    error: str                   # by how much the force on the hand is off, and why; empty: not told
    felt: str                    # the row that was felt
    names: dict                  # {law: what stands in its row}
    timeline: Timeline
    errors: dict                 # {law: [% per cell]}
    scores: dict                 # {law: {key: %}}
    reference: str = ""          # what the laws were held against, of most ticks
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


def share_text(share):
    """Never 100 % of less than all."""
    return f"{min(100 * share, 99.99):.4g} %" if share < 1 else "100 %"


def at_work(node):
    """Name and share of the law that was really at work in most ticks; None where nothing was."""
    law = node["law"].text()
    return (law, node["laws"][law].number()) if law else None


def names_of(methods):
    """{law: its name, and in brackets the law that was really at work in most of its ticks}."""
    names = {}
    for law in methods.keys():
        found = at_work(methods[law]["at_work"]) if "at_work" in methods[law] else None
        names[law] = law if not found or found[0] == law else f"{law} (as {found[0]} {share_text(found[1])})"
    return names


def felt_of(node, laws):
    """What was felt, for the title, and its row: that of the law really felt, or of the one asked for."""
    method = node["method"].text()
    found = at_work(node["rendered"]) if "rendered" in node else None
    if not found:
        return method, method
    law, share = found
    text = f"{law} {share_text(share)}" if share < 1 else law
    return text if law == method else f"{text} (asked: {method})", law if law in laws else method


# Keys of the percentages that the error on the hand adds up from, and their names.
PARTS_OF_ERROR = (("mesh_percent", "mesh"), ("motion_percent", "time step"), ("extrapolation_percent", "extrapolation"),
                  ("outages_percent", "outages"), ("fades_percent", "fades"), ("limits_percent", "limits"))


def two_figures(value):
    """Or all those before the point."""
    return f"{value:.2g}" if value < 99.5 else f"{value:.0f}"


def error_of(node):
    """"error of the force on the hand, of its RMS: at most 4.3 % ..." and its parts; empty of an older report."""
    felt = node["rendered"] if "rendered" in node else None
    if not felt or "total_percent" not in felt:
        return ""

    def text(key, name=""):
        percent = felt[key].number(or_null=True)
        return f"{name} unknown".strip() if math.isnan(percent) else f"{name} {two_figures(percent)} %".strip()

    unsettled = felt["unsettled_ticks"].number() if "unsettled_ticks" in felt else 0
    ticks = unsettled + sum(felt[key].number() for key in ("judged_ticks", "unjudged_ticks"))
    total = "not known" if math.isnan(felt["total_percent"].number(or_null=True)) else f"at most {text('total_percent')}"
    return (f"error of the force on the hand, of its RMS: {total} in the mean   ("
            + ", ".join(text(key, name) for key, name in PARTS_OF_ERROR)
            + f"; worst tick {text('hand_max_percent')}"
            + (f"; {two_figures(100 * unsettled / ticks)} % of the ticks could not be judged, since the server's own "
               "samples were not in balance)" if unsettled else ")"))


def read_tool(report, server, node, index, count):
    methods, line = node["methods"], node["timeline"]
    laws = methods.keys()
    felt_name, felt_row = felt_of(node, laws)
    scores = {law: {key: methods[law][key].number(or_null=True) for key, _, _ in PAPER_SCORES + SCORES}
              for law in laws}
    timeline = Timeline.read(line, ("ticks", "missed", "tick_us_mean", "tick_us_max", "samples",
                                    "step_ms_mean", "step_ms_max"), ("ticks", "missed"))
    if not timeline.edges:
        raise Unusable(f"{report.file}: {line.path}.cells is empty: no session to draw")
    tool = Tool(report.file, "", error_of(node), felt_row, names_of(methods), timeline, errors_of(line, laws), scores)
    if "reference" in node:
        tool.reference = node["reference"]["name"].text()
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
    parts = [scene, f"rendered: {felt_name}", f"{tool.rate_hz:g} Hz" if tool.rate_hz else "",
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
