#!/usr/bin/python3
"""Draw the force of a haptic trace as it came, a quarter as fast: one law in steps, another beside it.

TRACE.csv is what `haptic_client run ... --trace` or `scripts/run` writes (scripts/plotting/force.py
says which columns). Left the first law, right the second, both over the same samples: an impulse
stands where the tool was when its force was computed, and appears when that force arrived. Below 700 kB
as a GIF. Needs Debian's python3-matplotlib.

example: scripts/plotting/laws_animation.py out/trace.csv out/laws.gif --laws constant two_tangents --seconds 6 6.8

Exit status: 0 drawn, 2 the trace or the arguments cannot be used.
"""

import argparse
import math
import sys
from pathlib import Path

from force import first_contact_window, laws_of, norm_of_force, read_trace
from pictures import in_words, prepare, style_of_laws
from session_report import Unusable

SIZE_INCHES, DPI = (8, 3.2), 100
FRAMES_A_SECOND, SLOWER, REST_SECONDS = 12, 4, 1.5  # of the picture; than it was; at the end


def samples_with_arrival(trace, begin, end):
    """[(when it arrived, time of the tool's pose, |F|)] of the samples in the window."""
    rows = zip(trace["t_s"], trace["sample_t_s"], trace["sample_n"])
    return [row for row in rows if not math.isnan(row[1]) and begin <= row[1] <= end]


def prepare_panel(axes, law, colour, window, top):
    axes.set(xlim=window, ylim=(0, 1.08 * top), xlabel="time (s)")
    axes.set_title(in_words(law), loc="left", color=colour, weight="bold")
    axes.grid(alpha=0.3)
    (line,) = axes.plot([], [], color=colour, linewidth=2.2, drawstyle="steps-post" if law == "constant" else "default")
    (stems,) = axes.plot([], [], color="#000000", linewidth=0.8, alpha=0.35)
    (heads,) = axes.plot([], [], "o", color="#000000", markersize=4)
    return line, stems, heads


def animate(trace, laws, window):
    from matplotlib.animation import FuncAnimation
    pyplot = prepare(**{"font.size": 11})
    begin, end = window
    rows = [i for i, time in enumerate(trace["t_s"]) if begin <= time <= end]
    if len(rows) < 2:
        raise Unusable(f"--seconds {begin:g} {end:g}: nothing there")
    times = [trace["t_s"][i] for i in rows]
    forces = {law: [trace[f"{law}_n"][i] for i in rows] for law in laws}
    samples = samples_with_arrival(trace, begin, end)
    top = max([v for line in forces.values() for v in line if not math.isnan(v)] + [s[2] for s in samples] + [1e-3])
    figure, panels = pyplot.subplots(1, 2, figsize=SIZE_INCHES, dpi=DPI, facecolor="white", sharey=True,
                                     layout="constrained")
    panels[0].set_ylabel("force on the hand (N)")
    figure.suptitle("dots: what the simulation computed; lines: what a law gives the hand", fontsize=11)
    styles = style_of_laws(laws)
    drawn = [prepare_panel(axes, law, styles[law][0], window, top) for axes, law in zip(panels, laws)]

    moving = max(2, round((end - begin) * SLOWER * FRAMES_A_SECOND))

    def show(frame):
        now = min(end, begin + (end - begin) * (frame + 1) / moving)
        shown = sum(time <= now for time in times)
        come = [(t, force) for arrived, t, force in samples if arrived <= now]
        for law, (line, stems, heads) in zip(laws, drawn):
            line.set_data(times[:shown], forces[law][:shown])
            stems.set_data([t for t, _ in come for t in (t, t, math.nan)],
                           [y for _, force in come for y in (0, force, math.nan)])
            heads.set_data([t for t, _ in come], [force for _, force in come])
        return [artist for panel in drawn for artist in panel]

    return FuncAnimation(figure, show, frames=moving + round(REST_SECONDS * FRAMES_A_SECOND), blit=False)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("trace", type=Path, metavar="TRACE.csv")
    parser.add_argument("output", type=Path, metavar="OUT.gif")
    parser.add_argument("--laws", nargs=2, default=["constant", "two_tangents"], metavar=("LEFT", "RIGHT"),
                        help="of those that the trace has (default: constant two_tangents)")
    parser.add_argument("--seconds", type=float, nargs=2, metavar=("A", "B"),
                        help="what is shown, in the trace's time (default: the first contact)")
    arguments = parser.parse_args()
    try:
        if arguments.output.suffix != ".gif":
            raise Unusable(f"{arguments.output}: the name must end in .gif")
        trace = read_trace(arguments.trace)
        for law in arguments.laws:
            if law not in laws_of(trace):
                raise Unusable(f"--laws {law}: {arguments.trace} has {', '.join(laws_of(trace)) or 'none'}")
        window = arguments.seconds or first_contact_window(trace["t_s"], norm_of_force(trace))
        film = animate(trace, arguments.laws, tuple(window))
        from matplotlib.animation import PillowWriter
        film.save(arguments.output, writer=PillowWriter(fps=FRAMES_A_SECOND))
    except Unusable as problem:
        print(f"laws_animation.py: {problem}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"laws_animation.py: {arguments.output}: {error.strerror or error}", file=sys.stderr)
        return 2
    except ImportError:
        print("laws_animation.py: matplotlib is missing: apt-get install python3-matplotlib", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
