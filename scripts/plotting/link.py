#!/usr/bin/python3
"""Draw what scripts/study link computed: a heat map of the error that is felt on bad networks.

DIR holds summary.json. Written beside it: link.png, losses against delays, jitter and
reordering; each cell has the mean error of the felt force (percent of its root mean square)
and, below it, ms from the first sample to the first tick of the chosen law itself. Needs
Debian's python3-matplotlib.

Exit status: 0 drawn, 2 the folder cannot be used.
"""

import json
import math
import sys

from pictures import draw_folder, save

LOWEST, HIGHEST = 0.01, 100  # percent: the ends of the colours


def unique(rows, *keys):
    return sorted({tuple(row[key] for key in keys) for row in rows})


def text_of(row):
    law = row["law_itself_ms"]
    return f"{row['error_percent']['mean']:.2g} %\n{'never' if law is None else f'{law:.0f} ms'}"


def draw_study(folder, note, extra):
    from matplotlib import pyplot
    rows = json.loads((folder / "summary.json").read_text(encoding="ascii"))
    lines = unique(rows, "bursts", "loss_percent")
    columns = unique(rows, "delay_ms", "jitter_ms", "reordered_percent")
    found = {(r["bursts"], r["loss_percent"], r["delay_ms"], r["jitter_ms"], r["reordered_percent"]): r for r in rows}
    figure, axes = pyplot.subplots(figsize=(3 + 0.8 * len(columns), 2.5 + 0.55 * len(lines)), layout="constrained")
    errors = [[max(found[*line, *column]["error_percent"]["mean"], LOWEST) for column in columns] for line in lines]
    image = axes.imshow([[math.log10(min(e, HIGHEST)) for e in line] for line in errors], aspect="auto", cmap="RdYlGn_r",
                        vmin=math.log10(LOWEST), vmax=math.log10(HIGHEST))
    for i, line in enumerate(lines):
        for j, column in enumerate(columns):
            axes.text(j, i, text_of(found[*line, *column]), ha="center", va="center", fontsize=7)
    axes.set_xticks(range(len(columns)), [f"{d:g} ms, jitter {j:g} ms,\nreordered {r:g} %" for d, j, r in columns], fontsize=7,
                    rotation=45, ha="right")
    axes.set_yticks(range(len(lines)), [f"{loss:g} % lost{' in bursts' if bursts else ''}" for bursts, loss in lines], fontsize=8)
    axes.set_title("Mean error of the felt force, and time to the chosen law" + (f"\n{note}" if note else ""), fontsize=10)
    bar = figure.colorbar(image, ticks=[-2, -1, 0, 1, 2])
    bar.ax.set_yticklabels(["0.01 %", "0.1 %", "1 %", "10 %", "100 %"])
    save(figure, folder / "link.png", extra, 110)


sys.exit(draw_folder("link.py", "scripts/study link", __doc__, draw_study))
