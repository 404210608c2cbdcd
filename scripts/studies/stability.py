#!/usr/bin/python3
"""Find the stiffest wall that each law keeps stable in each hand, over rates and latencies.

Called by scripts/study, which builds the program first; that program (tests/studies) does
the work, in virtual time, over a simulated link: a hand presses against a wall with 1.5 N,
and the stiffness at which the loop begins to oscillate is found by bisection, to 5 %, over
5 seeds. World press_and_slide: it presses a sphere of 6 mm on a block of finite elements
(60 x 24 x 40 mm, edges of 2 mm under the path, nu 0.45, E such that the force has that
slope at 1.5 N), as the server simulates it, and slides to and fro by 6 mm for 3 s; tried
are 835, 1431, 2428, 3651 and 6413 N/m, and the direct limit is the last of them.
press_and_slide_swinging: the same with a tissue 30 times as heavy, which swings (reduced,
rayleigh_mass 10 1/s), at 30 steps a second, without an error of the force. The same
with _compliance_0.7 and _1.3: local_contact is told so many times the tissue's compliance
(30 Hz, 38 ms).

Writes into --out: summary.json and stability.csv (a row for each operator, law, wall, link,
and with passivity or without). The same bytes each time.

Exit status: 0 done, 1 the program failed, 2 wrong use.
"""

import sys

from one_program import main

sys.exit(main("stability_study", __doc__, "one link only: 30 Hz, 38 ms; press_and_slide in one hand"))
