"""What the pictures of Palpate share: colours, names in words, and how they are saved."""

import argparse
import json
import os
import sys
from pathlib import Path

FORMATS = ("png", "pdf", "svg")
DPI = 100

# A law has one colour everywhere: in these pictures, in studies and on the page.
LAW_COLOURS = Path(__file__).resolve().parents[2] / "common" / "law_colours.json"
LAW_STYLES = {law: (row["light"], (0, (4, 2)) if row["dashed"] else "-")
              for law, row in json.loads(LAW_COLOURS.read_text(encoding="ascii")).items()}
UNKNOWN_STYLE = ("#7f7f7f", ":")  # of a law that is not in that list
# Keys whose words are not just the key with spaces.
WORDS = {
    "linear_time": "linear in time", "linear_position": "linear in position",
    "linear_position_signed": "linear in position, signed",
    "quasi_static": "quasi-static", "stvk": "St. Venant-Kirchhoff", "neo_hookean": "neo-Hookean",
    "p1": "linear elements", "p2": "quadratic elements", "p1_nodal_pressure": "linear elements, nodal pressure",
}


class CannotSave(Exception):
    """A picture cannot be written; the text is for the user."""


def in_words(key):
    return WORDS.get(key) or key.replace("_", " ")


def style_of_laws(laws):
    return {law: LAW_STYLES.get(law, UNKNOWN_STYLE) for law in laws}


def quick_note(folder):
    """What a picture of a study's folder says of --quick; empty of a whole study."""
    try:
        quick = json.loads((folder / "study.json").read_text(encoding="ascii")).get("quick") is True
    except (OSError, ValueError, AttributeError):
        quick = False
    return "quick study (--quick): too few cases to judge by" if quick else ""


def plain_numbers(panel):
    """Logarithmic axes with numbers, not powers."""
    from matplotlib import ticker
    for axis in (panel.xaxis, panel.yaxis):
        if axis.get_scale() == "log":
            low, high = axis.get_view_interval()
            axis.set_major_locator(ticker.LogLocator(subs=(1, 2, 3, 5) if high < 1000 * low else (1,)))
            axis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:g}"))
            axis.set_minor_formatter(ticker.NullFormatter())


def add_format(parser):
    parser.add_argument("--plot-format", choices=FORMATS, default="png",
                        help="write each picture in this format, too, beside the PNG")


def files_of(png, extra):
    """Where a picture goes: PNG always, and beside it what --plot-format asks for."""
    return [png] if extra == "png" else [png, png.with_suffix(f".{extra}")]


def prepare(**more):
    """The one look of all pictures; call before anything is drawn. Text in a PDF stays text."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    pyplot.rcParams.update({"axes.spines.top": False, "axes.spines.right": False, "axes.axisbelow": True,
                            "text.parse_math": False, "pdf.fonttype": 42, "svg.fonttype": "none", **more})
    return pyplot


def draw_folder(script, made_by, doc, draw):
    """The whole command line of a script that draws what a study left in a folder: `draw(folder, note, extra)`, with
    what `quick_note` says and the other format. Returns the exit status, after one line where there is trouble."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dir", type=Path, metavar="DIR")
    add_format(parser)
    arguments = parser.parse_args()
    try:
        prepare()
        draw(arguments.dir, quick_note(arguments.dir), arguments.plot_format)
    except CannotSave as problem:
        print(f"{script}: {problem}", file=sys.stderr)
        return 2
    except ImportError:
        print(f"{script}: matplotlib is missing: apt-get install python3-matplotlib", file=sys.stderr)
        return 2
    except (OSError, ValueError, LookupError, TypeError) as error:
        print(f"{script}: {arguments.dir}: {error}; {made_by} makes it", file=sys.stderr)
        return 2
    return 0


def save(figure, png, extra="png", dpi=DPI):
    """Writes each file whole or not at all, and closes the figure."""
    from matplotlib import pyplot
    for path in files_of(png, extra):
        if path.is_dir():
            raise CannotSave(f"{path}: is a directory")
        draft = path.with_name(f".{path.name}.{os.getpid()}")
        try:
            figure.savefig(draft, format=path.suffix[1:], dpi=dpi, facecolor="white")
            draft.replace(path)
        except OSError as error:
            raise CannotSave(f"{path}: {error.strerror or error}") from None
        finally:
            draft.unlink(missing_ok=True)
    pyplot.close(figure)
