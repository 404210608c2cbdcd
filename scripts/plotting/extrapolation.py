#!/usr/bin/python3
"""Draw what scripts/study extrapolation computed, and print its tables.

DIR holds summary.csv and figures_*.csv. Written beside them: paper_table.csv and .txt
(the paper's table, next to what it published), paper_rates.csv and .txt (its lower
rates), laws.csv and .txt (mean over the motions,
in the contact of the block), worlds.csv and .txt (in every world), figure3.png and figure4_LAW.png (the paper's, redrawn for
each law), error_rate.png, error_speed.png, error_delay.png, error_spacing.png (error
against each, means over the motions) and error_cost.png (against run time and bytes, with
the Pareto front). Needs Debian's python3-matplotlib.

Exit status: 0 drawn, 2 the folder cannot be used.
"""

import argparse
import csv
import math
import statistics
import sys
from pathlib import Path

from pictures import CannotSave, add_format, in_words, plain_numbers, prepare, quick_note, save, style_of_laws

SPEED, RATE = 0.017, 33.3
# Picinbono and Lombardo (1999): average and maximal error, maximal force, %.
PUBLISHED = {"constant": (1.1, 56, 133), "linear_time": (0.3, 9, 109), "linear_position": (0.1, 7, 106)}
PAPER_KEYS = ("paper_mean_percent", "paper_max_percent", "paper_max_force_percent")
TEXTS = ("world", "motion", "reference", "method")
COMPONENTS = ((0, "along x"), (1, "upwards"))  # of the polar drawings
AXES = ("fx_n", "fy_n", "fz_n")
TRUE_COLOUR = "#BBBBBB"


class Unusable(Exception):
    """The folder cannot be used; the text is for the user."""


def read_rows(path):
    try:
        with open(path, newline="", encoding="ascii") as file:
            rows = list(csv.DictReader(file))
        for row in rows:
            for key, value in row.items():
                if key == "blended":
                    row[key] = value == "True"
                elif key not in TEXTS:
                    row[key] = float(value) if value else math.nan
    except (OSError, ValueError, TypeError) as error:
        raise Unusable(f"{path}: {getattr(error, 'strerror', None) or error}") from None
    if not rows:
        raise Unusable(f"{path}: has no rows")
    return rows


def require_study(rows, path):
    """That these are the rows of a study, and that the block, which most drawings are of, is among them."""
    missing = {"world", "reference", "method", "blended", "speed_m_s", "rate_hz", "delay_ms"} - set(rows[0])
    what = f"no column {min(missing)}" if missing else ""
    if not missing and not chosen(rows, world="block", reference="truth", speed_m_s=SPEED, rate_hz=RATE):
        what = f"no rows of the block against the truth at {SPEED:g} m/s and {RATE:g} Hz"
    if what:
        raise Unusable(f"{path}: {what}; this draws what scripts/study extrapolation --out DIR wrote")


def chosen(rows, **wanted):
    return [row for row in rows if all(row[key] == value for key, value in wanted.items())]


def values(rows, key):
    return list(dict.fromkeys(row[key] for row in rows))


def average(rows):
    """Over motions: the mean, but the worst of maxima and the median of times; None without rows."""
    if not rows:
        return None

    def of(key):
        if "_max_" in f"_{key}" or key == "jump_percent":
            return max
        return statistics.median if key.startswith("ns_") else statistics.fmean

    return {key: of(key)(row[key] for row in rows) for key in rows[0] if key not in TEXTS and key != "blended"}


def write_table(folder, name, title, header, lines):
    """A CSV, and the same as text, which is also printed. A space in the header: a new line in the text."""
    with open(folder / f"{name}.csv", "w", newline="", encoding="ascii") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([head.replace(" ", "_").replace("%", "percent") for head in header])
        writer.writerows([[f"{x:.6g}" if isinstance(x, float) else x for x in line] for line in lines])
    heads = [(head + "   ").split(" ")[:3] for head in header]
    table = [*zip(*heads),
             *([f"{x:.3f}" if isinstance(x, float) else x for x in line] for line in lines)]
    widths = [max(9, *map(len, column)) + 1 for column in zip(*table)]
    text = [title, *filter(None, [quick_note(folder)])] + [f"{law:<24}" + "".join(f"{cell:>{width}}" for cell, width in zip(cells, widths[1:]))
                      for law, *cells in table]
    (folder / f"{name}.txt").write_text("\n".join(text) + "\n", encoding="ascii")
    print("\n".join(text) + "\n")


# What stands in the paper's table: its name there, world, motions. Left and right: the two instruments.
EXPERIMENTS = (
    ("10mm", "pull_quasi_static", ("left_10mm", "right_10mm")),
    ("20mm", "pull_quasi_static", ("left_20mm", "right_20mm")),
    ("40mm", "pull_quasi_static", ("left_40mm", "right_40mm")),
    ("20mm-tensor-mass", "pull_tensor_mass", ("left_20mm", "right_20mm")),
    ("20mm-at-samples", "pull_quasi_static", ("left_20mm_at_samples", "right_20mm_at_samples")),
    ("spring", "grasp", ("manipulation",)))


def paper_table(rows, folder):
    """% of the force on the line between the samples, 33.3 Hz, no delay."""
    rows = chosen(rows, reference="paper", blended=False)
    long_run = chosen(rows, rate_hz=RATE)
    header, lines = ["law"], []
    for who in ("published", *(name for name, _, _ in EXPERIMENTS)):
        header += [f"{who} average %", f"{who} maximal %", f"{who} max-force %"]
    for law in values(rows, "method"):
        line = [law, *(float(x) for x in PUBLISHED.get(law, ()))]
        line += [""] * (4 - len(line))
        for _, world, motions in EXPERIMENTS:
            found = average([row for row in chosen(long_run, world=world, method=law) if row["motion"] in motions])
            line += [found[key] if found else "" for key in PAPER_KEYS]
        lines.append(line)
    write_table(folder, "paper_table",
                f"The paper's table: % of the interpolated force, {RATE:g} Hz, {SPEED:g} m/s on average, 0.078 m/s at "
                "most, no delay\n(a liver pulled by so many mm on average by two instruments: average of both, larger of "
                "the maxima; at-samples: their\nmotion known at the samples only; spring: a grasped organ on a spring "
                "that was chosen for the published averages)", header, lines)


def paper_rates(rows, folder):
    """Average and maximal error at the rates that the paper made of 80 Hz."""
    rows = [row for row in chosen(rows, reference="paper", blended=False, world="pull_quasi_static")
            if row["motion"] in ("left_20mm", "right_20mm") and row["rate_hz"] != RATE]
    rates = sorted(values(rows, "rate_hz"), reverse=True)
    lines = []
    for law in values(rows, "method"):
        found = [average(chosen(rows, method=law, rate_hz=rate)) for rate in rates]
        lines.append([law, *(row[key] for row in found for key in PAPER_KEYS[:2])])
    write_table(folder, "paper_rates",
                "The same liver, pulled by 20 mm: one sample of 1, 2, 3, 4 at 80 Hz, % of the line between those kept",
                ["law"] + [f"{rate:g}_Hz {what} %" for rate in rates for what in ("average", "maximal")], lines)


def law_table(rows, folder):
    rows = chosen(rows, world="block", reference="truth", speed_m_s=SPEED, rate_hz=RATE)
    delays = sorted(values(rows, "delay_ms"))
    header = ["law", "blended"] + [f"{delay:g}_ms {what} %" for delay in delays for what in ("mean", "p99", "max")]
    lines = []
    for blended in (False, True):
        for law in values(rows, "method"):
            line = [law, "yes" if blended else "no"]
            for delay in delays:
                found = average(chosen(rows, method=law, blended=blended, delay_ms=delay))
                line += [found[key] for key in ("mean_percent", "p99_percent", "max_percent")]
            lines.append(line)
    write_table(folder, "laws",
                f"Against the true force: block, {RATE:g} Hz, {SPEED:g} m/s; mean in % of RMS, p99 and max in % of "
                "peak\n(average of five motions; max: the worst of them)", header, lines)


def world_table(rows, folder):
    rows = [row for row in chosen(rows, reference="truth", rate_hz=RATE, blended=False)
            if row["motion"] == "presses" or row["speed_m_s"] == SPEED]
    delay = min(values(rows, "delay_ms"), key=lambda d: abs(d - 35))
    rows = [{**row, "world": row["world"] + ("_presses" if row["motion"] == "presses" else "")} for row in rows]
    worlds = values(rows, "world")
    lines = []
    for law in values(rows, "method"):
        found = [average(chosen(rows, method=law, world=world, delay_ms=delay)) for world in worlds]
        lines.append([law, *(row[key] if row else "" for row in found for key in ("mean_percent", "max_percent"))])
    header = ["law"] + [f"{world} {what} %" for world in worlds for what in ("mean", "max")]
    write_table(folder, "worlds", f"Against the true force in every world: {RATE:g} Hz, {SPEED:g} m/s (presses faster), {delay:g} ms\n"
                "(average of the motions; max: the worst of them; presses apart)", header, lines)


class Sheets:
    """Where the pictures of a study go, and what each says of it below."""

    def __init__(self, folder, extra):
        self.folder, self.extra, self.note = folder, extra, quick_note(folder)

    def save(self, figure, name):
        if self.note:
            figure.supxlabel(self.note, color="#B00020", weight="bold")
        save(figure, self.folder / f"{name}.png", self.extra)


def draw_errors(rows, styles, x_of, x_name, name, sheets):
    """Mean and p99 (rows) against x, a panel for each delay; left out with a single x."""
    from matplotlib import pyplot
    delays = sorted(values(rows, "delay_ms"))
    if len({x_of(row) for row in rows}) < 2:
        return
    columns = delays if x_name != "delay (ms)" else [None]
    figure, panels = pyplot.subplots(2, len(columns), figsize=(5.5 * len(columns) + 3, 10), sharey="row",
                                     squeeze=False, layout="constrained")
    for column, delay in enumerate(columns):
        here = rows if delay is None else chosen(rows, delay_ms=delay)
        for panel, key, unit in zip(panels[:, column], ("mean_percent", "p99_percent"), ("RMS", "peak")):
            for law, (colour, line) in styles.items():
                mine = chosen(here, method=law)
                xs = sorted({x_of(row) for row in mine})
                ys = [average([row for row in mine if x_of(row) == x])[key] for x in xs]
                panel.plot(xs, ys, "o", linestyle=line, color=colour, label=in_words(law), markersize=4)
            panel.set(yscale="log", xlabel=x_name)
            if x_name != "delay (ms)":
                panel.set_xscale("log")
            plain_numbers(panel)
            panel.grid(alpha=0.3)
            if column == 0:
                panel.set_ylabel(f"{key.removesuffix('_percent')} error (% of {unit} force)")
        if delay is not None:
            panels[0, column].set_title(f"delay {delay:g} ms")
    figure.suptitle("Error of each law against the true force: block, average of the motions")
    panels[0, -1].legend(loc="upper left", bbox_to_anchor=(1.02, 1), fontsize=11)
    sheets.save(figure, name)


def pareto(points):
    """Those (x, y, ...) that no other beats in both."""
    return sorted(p for p in points
                  if not any(q[0] <= p[0] and q[1] <= p[1] and q[:2] != p[:2] for q in points))


def model_bytes_note(laws):
    """A second line for the axis: what comes once besides, of each law that has such a thing."""
    once = [f"{in_words(law)} {found['model_bytes'] / 1e6:.2g} MB" for law, found in laws.items() if found["model_bytes"] > 0]
    return f"\nand once, for the model of the surface: {', '.join(once)}" if once else ""


def draw_cost(rows, styles, sheets):
    """Mean and p99 against time per tick and bytes per second, at the delay nearest to 35 ms."""
    from matplotlib import pyplot
    rows = chosen(rows, world="block", speed_m_s=SPEED, rate_hz=RATE)
    delay = min(values(rows, "delay_ms"), key=lambda d: abs(d - 35))
    laws = {law: average(chosen(rows, method=law, delay_ms=delay)) for law in styles}
    figure, panels = pyplot.subplots(2, 2, figsize=(16, 11), sharey="row", layout="constrained")
    costs = (("ns per tick: median (line: to p99 where a few ticks do the work)", lambda a: a["ns_per_tick"]),
             ("bytes per second" + model_bytes_note(laws), lambda a: RATE * a["bytes_per_sample"]))
    for column, (cost_name, cost) in enumerate(costs):
        for panel, key, unit in zip(panels[:, column], ("mean_percent", "p99_percent"), ("RMS", "peak")):
            points = [(cost(found), found[key], law) for law, found in laws.items()]
            front = pareto(points)
            panel.plot(*zip(*((x, y) for x, y, _ in front)), color="#7F7F7F", linewidth=6, alpha=0.4,
                       solid_capstyle="round", label="Pareto front: ringed")
            for x, y, law in points:
                on = any(law == best for _, _, best in front)
                panel.plot(x, y, "o", color=styles[law][0], markersize=11, markeredgewidth=2.5, label=in_words(law),
                           markeredgecolor="black" if on else styles[law][0])
                if column == 0 and laws[law]["ns_per_tick_p99"] > 0:
                    panel.plot([x, laws[law]["ns_per_tick_p99"]], [y, y], "-|", color=styles[law][0], markersize=11)
            panel.set(xscale="log", yscale="log", xlabel=cost_name,
                      ylabel=f"{key.removesuffix('_percent')} error (% of {unit} force)")
            panel.margins(x=0.1, y=0.1)
            plain_numbers(panel)
            panel.grid(alpha=0.3, which="both")
    panels[0, -1].legend(loc="upper left", bbox_to_anchor=(1.02, 1), fontsize=11)
    figure.suptitle(f"Error against cost: block, {RATE:g} Hz, {SPEED:g} m/s, {delay:g} ms, average of the motions")
    sheets.save(figure, "error_cost")


def forces_of(trace, name):
    return [[row[f"{name}_{axis}"] for row in trace] for axis in AXES]


def norms(forces):
    return [math.hypot(*force) for force in zip(*forces)]


def draw_samples(panel, trace):
    samples = [(row["sample_t_s"], row["sample_n"]) for row in trace if not math.isnan(row["sample_t_s"])]
    begin = trace[0]["t_s"]
    samples = [sample for sample in samples if sample[0] >= begin]
    stems = panel.stem(*zip(*samples), basefmt=" ", label="computed by the simulation")
    stems.stemlines.set(color="#000000", linewidth=0.8, alpha=0.4)
    stems.markerline.set(color="#000000", markersize=3)
    return samples


def polar(panel, forces, **style):
    """A force as a point: along x, and upwards."""
    panel.plot(*(forces[axis] for axis, _ in COMPONENTS), **style)
    panel.set(xlabel=f"force {COMPONENTS[0][1]} (N)", ylabel=f"force {COMPONENTS[1][1]} (N)")
    panel.grid(alpha=0.3)


def draw_figure3(trace, what, sheets):
    from matplotlib import pyplot
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(16, 6), layout="constrained", width_ratios=(2, 1))
    true = forces_of(trace, "true")
    left.plot([row["t_s"] for row in trace], norms(true), color=TRUE_COLOUR, linewidth=4, label="true force")
    samples = draw_samples(left, trace)
    left.plot(*zip(*samples), color="#D55E00", linewidth=1.2, label="the line between samples, the paper's reference")
    left.set(xlabel="time (s)", ylabel="|F| (N)", title=f"Figure 3: the reference; {what}")
    left.set_ylim(top=1.3 * max(norms(true)))  # room for the legend
    left.grid(alpha=0.3)
    left.legend(loc="upper right")
    polar(right, true, color="#333333", linewidth=1)
    right.set_title("the same, as a curve of the force")
    sheets.save(figure, "figure3")


def draw_figure4(traces, law, colour, sheets):
    """A row for each trace: force against time with the samples; difference to the reference."""
    from matplotlib import pyplot
    figure, panels = pyplot.subplots(len(traces), 2, figsize=(16, 5.5 * len(traces)), squeeze=False,
                                     layout="constrained", width_ratios=(2, 1))
    for (what, trace), (left, right) in zip(traces.items(), panels):
        times, true, mine = [row["t_s"] for row in trace], forces_of(trace, "true"), forces_of(trace, law)
        off = [[a - b for a, b in zip(*pair)] for pair in zip(mine, true)]
        left.plot(times, norms(true), color=TRUE_COLOUR, linewidth=4, label="reference: the true force")
        draw_samples(left, trace)
        left.plot(times, norms(mine), color=colour, linewidth=1.3, label=in_words(law))
        left.plot(times, norms(off), color="#332288", linewidth=0.8, label="difference")
        left.set(xlabel="time (s)", ylabel="|F| (N)", title=f"{in_words(law)}; {what}")
        left.set_ylim(top=1.5 * max(norms(true)))  # room for the legend
        left.grid(alpha=0.3)
        left.legend(loc="upper right", fontsize=10)
        polar(right, off, color=colour, linewidth=0.8)
        right.set_title(f"difference to the reference, mean {statistics.fmean(norms(off)):.4f} N")
        reach = 0.35 * max(norms(true))  # the same for every law, or they could not be compared
        right.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
    sheets.save(figure, f"figure4_{law}")


def draw(folder, extra):
    prepare(**{"font.size": 12})
    sheets = Sheets(folder, extra)
    rows = read_rows(folder / "summary.csv")
    require_study(rows, folder / "summary.csv")
    styles = style_of_laws(values(rows, "method"))
    paper_table(rows, folder)
    paper_rates(rows, folder)
    law_table(rows, folder)
    world_table(rows, folder)
    rows = chosen(rows, world="block", reference="truth", blended=False)
    draw_errors(chosen(rows, speed_m_s=SPEED), styles, lambda row: row["rate_hz"], "simulation rate (Hz)",
                "error_rate", sheets)
    draw_errors(chosen(rows, rate_hz=RATE), styles, lambda row: row["speed_m_s"], "mean speed of the tool (m/s)",
                "error_speed", sheets)
    draw_errors(chosen(rows, speed_m_s=SPEED, rate_hz=RATE), styles, lambda row: row["delay_ms"], "delay (ms)",
                "error_delay", sheets)
    draw_errors(rows, styles, lambda row: 1000 * row["speed_m_s"] / row["rate_hz"], "mm between samples",
                "error_spacing", sheets)
    draw_cost(rows, styles, sheets)
    traces = {}
    for path in sorted(folder.glob("figures_*.csv")):
        rate, delay = path.stem.removeprefix("figures_").split("_")
        traces[f"{rate.removesuffix('hz')} Hz, delay {delay.removesuffix('ms')} ms"] = read_rows(path)
    if traces:
        draw_figure3(*reversed(next(iter(traces.items()))), sheets)
        for law, (colour, _) in styles.items():
            draw_figure4(traces, law, colour, sheets)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, metavar="DIR")
    add_format(parser)
    arguments = parser.parse_args()
    try:
        draw(arguments.folder, arguments.plot_format)
    except (Unusable, CannotSave, OSError) as problem:
        print(f"extrapolation.py: {problem}", file=sys.stderr)
        return 2
    except ImportError:
        print("extrapolation.py: matplotlib is missing: apt-get install python3-matplotlib", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
