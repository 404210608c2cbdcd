#!/usr/bin/python3
"""Draw what scripts/study stability computed: a heat map for each kind of wall.

DIR holds summary.json. Written beside it: stability_WORLD.png, laws against operators and
links; each cell has the stiffness (N/m) up to which the loop is stable, without and with
passivity, and the colour says what share of the direct limit that is. A world with a wrong
compliance is a line in the map of the true one. Needs Debian's python3-matplotlib.

Exit status: 0 drawn, 2 the folder cannot be used.
"""

import json
import math
import sys

from pictures import draw_folder, in_words, save

LOWEST = 0.003  # of the direct limit: the end of the colours


def unique(rows, *keys):
    return list(dict.fromkeys(tuple(row[key] for key in keys) for row in rows))


def with_wrong_model(row):
    """Of a world that a law was told wrongly: the true one, and a law of its own."""
    world, _, share = row["world"].partition("_compliance_")
    return {**row, "world": world, "method": f"{row['method']} ({share} of compliance)" if share else row["method"]}


def share_of(row):
    """Of the direct limit; nan without a row."""
    return max(row["stable_to_n_m"] / row["direct_limit_n_m"], LOWEST) if row else math.nan


def draw(rows, world, file, note, extra):
    from matplotlib import pyplot
    laws = [law for (law,) in unique(rows, "method")]
    columns = unique(rows, "operator", "rate_hz", "delay_ms")
    found = {(r["method"], r["operator"], r["rate_hz"], r["delay_ms"], r["passivity"]): r for r in rows}
    figure, axes = pyplot.subplots(figsize=(4 + 0.95 * len(columns), 1.6 + 0.5 * len(laws)),
                                 layout="constrained")
    shares = [[share_of(found.get((law, *c, False))) for c in columns] for law in laws]
    image = axes.imshow([[math.log10(min(s, 1)) for s in line] for line in shares], aspect="auto", cmap="RdYlGn",
                        vmin=math.log10(LOWEST), vmax=0)
    for i, law in enumerate(laws):
        for j, c in enumerate(columns):
            if (law, *c, False) not in found:
                continue
            plain, passive = (found[(law, *c, p)]["stable_to_n_m"] for p in (False, True))
            axes.text(j, i, f"{plain:.0f}\n{passive:.0f}", ha="center", va="center", fontsize=7)
    axes.set_xticks(range(len(columns)), [f"{in_words(o)}\n{r:g} Hz, {d:g} ms" for o, r, d in columns], fontsize=7, rotation=45,
                    ha="right")
    axes.set_yticks(range(len(laws)), map(in_words, laws), fontsize=8)
    axes.set_title(f"{in_words(world)}: stable up to (N/m)\nwithout passivity, below with it"
                   + (f"\n{note}" if note else ""), fontsize=10)
    bar = figure.colorbar(image, ticks=[math.log10(x) for x in (0.003, 0.01, 0.03, 0.1, 0.3, 1)])
    bar.ax.set_yticklabels(["0.3 %", "1 %", "3 %", "10 %", "30 %", "100 %"])
    bar.set_label("of the direct limit, without passivity", fontsize=8)
    save(figure, file, extra, 110)


def draw_study(folder, note, extra):
    rows = [with_wrong_model(row) for row in json.loads((folder / "summary.json").read_text(encoding="ascii"))]
    for (world,) in unique(rows, "world"):
        draw([row for row in rows if row["world"] == world], world, folder / f"stability_{world}.png", note, extra)


sys.exit(draw_folder("stability.py", "scripts/study stability", __doc__, draw_study))
