#!/usr/bin/python3
"""Draw what sim_server study found, and the cost of meshes that scripts/study deformation measured.

DIR holds summary.json of sim_server study, or folders that do, and perhaps cost.json. Written
beside each summary.json: study.png, four sheets of a scene: error of the force against time a
step, with the front named; the felt error (deformation, extrapolation and lateness together)
against the server's time for a step; the error along the run; set-up time and memory. From
cost.json: cost.png, time a step against the size of the mesh. Needs Debian's
python3-matplotlib.

Exit status: 0 drawn, 2 the folder cannot be used.
"""

import csv
import json
import math
import re
import sys

from pictures import draw_folder, in_words, plain_numbers, save

LEAST = 1e-3  # %: what is less is drawn there
COLOURS = {"quasi_static": "tab:blue", "tensor_mass": "tab:orange", "implicit": "tab:green", "reduced": "tab:purple",
           "hybrid": "tab:red"}
MARKS = {"p1": "o", "p1_nodal_pressure": "s", "p2": "D"}
BETTER = {"fontsize": 8, "color": "0.35", "ha": "left", "va": "bottom"}


def colour_of(model):
    """A model that has none of its own is drawn in grey."""
    return COLOURS.get(model, "tab:gray")


def label_of(row):
    parts = [in_words(row["model"])]
    if row["law"] != "linear":
        parts.append(in_words(row["law"]))
    if row["element"] != "p1":
        parts.append(in_words(row["element"]))
    return ", ".join(parts) + f", {row['tetrahedra']} tetrahedra"


def case_in_words(name):
    """MODEL-LAW-ELEMENT-MESH-rN[-EDGEmm]-DTms[-TOLERANCE-ITERATIONS-INTEGRATION], for people; any other name as it is."""
    parts = re.fullmatch(r"(\w+)-(\w+)-(\w+)-(.+)-r(\d+(?:\.5)?)(?:-([\d.]+)mm)?-([\d.]+)ms(?:-.+)?", name)
    if not parts:
        return name
    model, law, element, mesh, refined, edge, step = parts.groups()
    once = {"0": "", "1": " refined once,"}.get(refined, f" refined {refined} times,")
    if edge:
        once += f" edges of {edge} mm,"
    return f"{in_words(model)}, {in_words(law)}, {in_words(element)} on {mesh},{once} steps of {float(step):.3g} ms"


def of_setting(row):
    return (row["model"], row["law"], row["element"], row["mesh"], row["refinements"])


def above(value):
    return max(value, LEAST)


def percents(axes):
    """At least a decade, with plain numbers beside it."""
    low, high = axes.get_ylim()
    if high < 10 * low:
        middle = math.sqrt(low * high)
        axes.set_ylim(middle / math.sqrt(10), middle * math.sqrt(10))
    plain_numbers(axes)


def name_points(axes, points):
    """Writes each name beside its point (x, y, name): inside the axes, on no other name, point or legend."""
    from matplotlib.transforms import Bbox
    renderer = axes.figure.canvas.get_renderer()
    taken = [axes.get_legend().get_window_extent(renderer)] if axes.get_legend() else []
    marks = [place for line in axes.lines for place in line.get_xydata()]
    taken += [Bbox.from_bounds(x - 4, y - 4, 8, 8) for x, y in map(axes.transData.transform, marks)]
    for x, y, name in points:
        for right, up in ((6, 4), (6, -10), (-6, 4), (-6, -10), (6, 13), (-6, 13), (6, -19), (-6, -19), (6, 22), (-6, 22),
                          (6, -28), (-6, -28), (6, 31), (-6, 31)):
            text = axes.annotate(name, (x, y), xytext=(right, up), textcoords="offset points", fontsize=6.5,
                                 ha="left" if right > 0 else "right")
            box = text.get_window_extent(renderer)
            inside = axes.bbox.x0 <= box.x0 and box.x1 <= axes.bbox.x1
            if inside and not any(box.overlaps(other) for other in taken):
                break
            text.remove()
        else:
            axes.annotate(name, (x, y), xytext=(6, 4), textcoords="offset points", fontsize=6.5)
        taken.append(box)


def draw_front(axes, rows):
    for row in rows:
        axes.loglog(row["step_ms_p50"], above(row["force_error_percent"]), MARKS[row["element"]],
                    color=colour_of(row["model"]), alpha=1 if row["on_front"] else 0.45,
                    markerfacecolor="white" if row["flagged_steps"] else None)
    if any(r["flagged_steps"] for r in rows):
        axes.plot([], [], "o", color="0.4", markerfacecolor="white", label="some steps did not settle")
    front = sorted((r for r in rows if r["on_front"]), key=lambda r: r["step_ms_p50"])
    axes.loglog([r["step_ms_p50"] for r in front], [above(r["force_error_percent"]) for r in front], "-", color="0.4",
                linewidth=0.8, zorder=0)
    named = {of_setting(r): r for r in reversed(front)}  # the fastest of each, whatever its step
    for model in dict.fromkeys(r["model"] for r in rows):
        axes.plot([], [], "o", color=colour_of(model), label=in_words(model))
    for element in dict.fromkeys(r["element"] for r in rows):
        axes.plot([], [], MARKS[element], color="0.4", label=in_words(element))
    percents(axes)
    axes.margins(x=0.25)
    axes.legend(fontsize=7)
    axes.set_xlabel("server, median time of a step in contact (ms)")
    axes.set_ylabel("error of the tool's force (%)")
    axes.set_title("Error against run time\n(better: lower and to the left; the line is the front)", fontsize=9)
    return [(r["step_ms_p50"], above(r["force_error_percent"]), label_of(r)) for r in reversed(named.values())]


def draw_felt(axes, rows):
    settings = dict.fromkeys(of_setting(r) for r in rows if r["axis"] in ("scene", "mesh", "step"))
    for setting in settings:
        line = sorted((r for r in rows if of_setting(r) == setting and r["axis"] != "tolerance"),
                      key=lambda r: r["dt_ms"])
        if len(line) < 2:
            continue
        (drawn,) = axes.loglog([r["dt_ms"] for r in line], [above(r["rendered_error_percent"]) for r in line], "--",
                               linewidth=0.9, label=label_of(line[0]))
        kept = [r for r in line if r["step_ms_p50"] <= r["dt_ms"]]
        axes.loglog([r["dt_ms"] for r in kept], [above(r["rendered_error_percent"]) for r in kept], "-o",
                    color=drawn.get_color())
        late = [r for r in line if r["step_ms_p50"] > r["dt_ms"]]
        axes.loglog([r["dt_ms"] for r in late], [above(r["rendered_error_percent"]) for r in late], "o",
                    color=drawn.get_color(), markerfacecolor="white")
    axes.plot([], [], "o", color="0.4", label="this machine keeps up")
    axes.plot([], [], "o", color="0.4", markerfacecolor="white", label="it does not: a step takes longer")
    percents(axes)
    axes.legend(fontsize=7)
    axes.set_xlabel("time that the server has for a step (ms)")
    axes.set_ylabel("felt error of the force (%)")
    axes.set_title("What the hand feels: deformation, extrapolation and lateness together\n"
                   "(better: lower; a finer mesh pays only where its full line is lower)", fontsize=9)


def draw_along(axes, rows, along):
    shown = [r for r in rows if r["axis"] in ("scene", "model", "element")]
    for row in shown:
        points = along.get(row["case"], [])
        axes.semilogy([t for t, _ in points], [above(e) for _, e in points], linewidth=1,
                      color=colour_of(row["model"]), linestyle={"p1": "-", "p2": ":"}.get(row["element"], "--"),
                      label=label_of(row))
    low, high = axes.get_ylim()
    axes.set_ylim(bottom=max(low, high / 1e4))  # nothing touches where it falls off
    plain_numbers(axes)
    axes.legend(fontsize=7)
    axes.set_xlabel("time (s): pressed, slid to and fro, lifted")
    axes.set_ylabel("error of the force, of its mean size (%)")
    axes.set_title("Error along the run\n(a line that climbs drifts)", fontsize=9)


def draw_price(axes, rows):
    shown = [r for r in rows if r["axis"] in ("scene", "model", "element", "mesh")]
    for row in shown:
        axes.loglog(row["setup_ms"] / 1e3, row["peak_bytes"] / 1e6, MARKS[row["element"]], color=colour_of(row["model"]))
    axes.margins(x=0.3, y=0.1)
    plain_numbers(axes)
    axes.set_xlabel("set-up (s)")
    axes.set_ylabel("peak memory of the process (MB)")
    axes.set_title("What it costs before the first step\n(better: lower and to the left)", fontsize=9)
    return [(r["setup_ms"] / 1e3, r["peak_bytes"] / 1e6, label_of(r)) for r in shown]


def read_along(file):
    along = {}
    with open(file, encoding="ascii", newline="") as lines:
        for row in csv.DictReader(lines):
            along.setdefault(row["case"], []).append((float(row["t_s"]), float(row["force_error_percent"])))
    return along


def draw_scene(folder, note, extra):
    from matplotlib import pyplot
    found = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    rows, truth = found["rows"], found["reference"]
    figure, axes = pyplot.subplots(2, 2, figsize=(15, 10), layout="constrained")
    timed = [r for r in rows if r["step_ms_p50"] is not None]  # others never touched
    front = draw_front(axes[0][0], timed)
    draw_felt(axes[0][1], timed)
    draw_along(axes[1][0], rows, read_along(folder / "along.csv"))
    dear = draw_price(axes[1][1], rows)
    closed = truth.get("closed_form_percent")
    figure.suptitle(f"{rows[0]['scene']}: against {case_in_words(truth['case'])}\n(the reference itself: {case_in_words(truth['check'])} differs "
                    f"from it by {truth['force_error_percent']:.2g} % in force"
                    + (f", is off the closed form of a sphere on an endless layer by {closed:+.2g} %" if closed else "")
                    + f"; link {found['latency_ms']:g} ms)"
                    + (f"\n{note}" if note else ""), fontsize=11)
    for sheet in axes.flat:
        sheet.grid(True, which="major", linewidth=0.3)
    figure.canvas.draw()
    figure.set_layout_engine("none")  # names are placed where the axes are now
    name_points(axes[0][0], front)
    name_points(axes[1][1], dear)
    save(figure, folder / "study.png", extra, 110)


def exponent(points):
    """Of cost = c size^e, by least squares of logarithms."""
    xs, ys = [math.log(x) for x, _ in points], [math.log(y) for _, y in points]
    x, y = sum(xs) / len(xs), sum(ys) / len(ys)
    return sum((a - x) * (b - y) for a, b in zip(xs, ys)) / sum((a - x) ** 2 for a in xs)


def draw_cost(folder, note, extra):
    from matplotlib import pyplot
    rows = json.loads((folder / "cost.json").read_text(encoding="utf-8"))
    figure, axes = pyplot.subplots(1, 2, figsize=(12, 5), layout="constrained")
    for sheet, key, unit, what in ((axes[0], "step_ms_p50", 1, "median time of a step in contact (ms)"),
                                   (axes[1], "setup_ms", 1e-3, "set-up (s)")):
        for model in dict.fromkeys(r["model"] for r in rows):
            points = sorted((r["tetrahedra"], unit * r[key]) for r in rows if r["model"] == model)
            text = in_words(model) + (f", exponent {exponent(points):.2f}" if len(points) > 1 else "")
            sheet.loglog(*zip(*points), "-o", color=colour_of(model), label=text)
        sheet.set_xlabel("tetrahedra")
        sheet.set_ylabel(what)
        plain_numbers(sheet)
        sheet.grid(True, which="major", linewidth=0.3)
        sheet.legend(fontsize=8)
    figure.suptitle("Cost against the size of the mesh (better: lower, and flatter)"
                    + (f"\n{note}" if note else ""), fontsize=11)
    save(figure, folder / "cost.png", extra, 110)


def draw_study(folder, note, extra):
    # Scenes of an earlier study, of more of them, are not of this one.
    scenes = folder / "scenes.json"
    within = [folder / name for name in json.loads(scenes.read_text(encoding="utf-8"))] if scenes.exists() else [folder, *sorted(folder.glob("*/"))]
    folders = [f for f in within if (f / "along.csv").exists()]
    if not folders:
        raise ValueError("no summary.json with along.csv")
    for one in folders:
        draw_scene(one, note, extra)
    if (folder / "cost.json").exists():
        draw_cost(folder, note, extra)


sys.exit(draw_folder("deformation.py", "sim_server study", __doc__, draw_study))
