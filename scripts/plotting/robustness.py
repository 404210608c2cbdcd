#!/usr/bin/python3
"""Draw what scripts/study robustness found: one table, cases by models, outcome by colour.

DIR holds summary.json. Written beside it: robustness.png. A stable or flagged cell has its error
against the reference; the error of a body that was flung about is how far it is from rest, in
percent of its size. Needs Debian's python3-matplotlib.

Exit status: 0 drawn, 2 the folder cannot be used.
"""

import json
import sys
import textwrap

from pictures import draw_folder, in_words, save

COLOURS = {"stable": "#b8e0c2", "flagged": "#fbe3a1", "refused": "#c9d6ea", "not_applicable": "#f2f2f2",
           "wrong": "#e4604e", "exploded": "#9c2f6e"}
MEANINGS = {"stable": "stable: error of the force at the end, or of the shape where no tool is", "flagged": "flagged: a defined answer, told to be unsettled",
            "refused": "refused: the program says what to change", "not_applicable": "makes no sense for this model",
            "wrong": "wrong: an unflagged force off by more than the bound, or of the wrong sign; a surface that stays off",
            "exploded": "exploded: not finite, or no answer"}
# What a refusal is about, in a word.
WHY = {"sub-steps": "too many\nsub-steps", "no fixed nodes": "nothing\nholds it", "small turns": "nothing\nholds it",
       "can turn about": "it can\nturn", "hang on a hinge": "it can\nturn",
       "is for law": "material\nit cannot", "does not deform": "material\nit cannot", "bears tools only": "tools\nonly",
       "not in this build": "not in\nthis build"}


def number(value):
    """Errors below 0.01 % are none to a hand."""
    return "< 0.01 %" if value < 0.01 else f"{value:.2g} %" if value < 100 else f"{value:.0f} %" if value < 1e4 else f"{value:.0e} %"


def in_cell(row):
    if row["outcome"] == "not_applicable":
        return ""
    if row["outcome"] == "refused":
        return next((short for part, short in WHY.items() if part in row["reason"]), "refused")
    if row["error_percent"] is not None:
        elsewhere = "place to rest" in row["reason"]
        return number(row["error_percent"]) + ("\nanother rest" if elsewhere else "")
    return "\n".join(textwrap.wrap(row["reason"].split(",")[0], 16)[:2])


def draw(rows, file, note, extra):
    from matplotlib import pyplot
    from matplotlib.patches import Patch, Rectangle
    cases, models = list(dict.fromkeys(r["case"] for r in rows)), list(dict.fromkeys(r["model"] for r in rows))
    said = {r["case"]: r["what"] for r in rows}
    figure, axes = pyplot.subplots(figsize=(4.6 + 1.25 * len(models), 1.9 + 0.42 * len(cases)), layout="constrained")
    for row in rows:
        x, y = models.index(row["model"]), cases.index(row["case"])
        axes.add_patch(Rectangle((x - 0.48, y - 0.46), 0.96, 0.92, color=COLOURS[row["outcome"]], lw=0))
        axes.text(x, y, in_cell(row), ha="center", va="center", fontsize=7.5, linespacing=0.95)
    axes.set_xlim(-0.5, len(models) - 0.5)
    axes.set_ylim(len(cases) - 0.5, -0.5)
    axes.set_xticks(range(len(models)), [in_words(m).replace(" ", "\n") for m in models], fontsize=9)
    axes.set_yticks(range(len(cases)), [in_words(c) + "\n" + said[c] for c in cases], fontsize=8, linespacing=0.95)
    axes.xaxis.tick_top()
    axes.tick_params(length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)
    axes.set_title("Extreme scenes: what each model makes of them" + (f"\n{note}" if note else ""), fontsize=12, pad=12)
    used = [o for o in COLOURS if any(r["outcome"] == o for r in rows)]
    axes.legend(handles=[Patch(color=COLOURS[o], label=MEANINGS[o]) for o in used], loc="upper center", ncol=2,
                bbox_to_anchor=(0.5, -0.01), fontsize=8, frameon=False)
    save(figure, file, extra, 110)


def draw_study(folder, note, extra):
    draw(json.loads((folder / "summary.json").read_text(encoding="ascii")), folder / "robustness.png", note, extra)


sys.exit(draw_folder("robustness.py", "scripts/study robustness", __doc__, draw_study))
