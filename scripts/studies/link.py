#!/usr/bin/python3
"""Find what a bad network costs a session: loss, delay, jitter, bursts, reordering, in virtual time.

Called by scripts/study, which builds the program first; that program (tests/studies) does
the work: both ends of a session with the whole tick of the client, at 1000 Hz, and the liver
of 1999 at 30 steps a second, palpated by the hand of its client file for 15 s. The links,
the same each way, lose 0 to 30 % (each on its own, or in bursts of 8 datagrams on the mean),
delay by 0 to 200 ms (round trip), scatter by up to 30 ms, and hold a tenth back by 40 ms;
from 9 s on they only delay. Each row has: ms from the start to the Welcome, and from the
first sample to the first tick of the chosen law itself; samples used; their age; the error of
what was felt against the force that the organ has for the place of the tool then, every seventh
tick, so that all ages of a sample count (percent of its root mean square), from 3 to 9 s, and
healed, from 11 s on; the largest and the steepest force. An organ that moves by itself has no
force between its steps: of it (--scene) the ticks count for which it computed one. Errors are
those of link and extrapolation alone, and next to nothing where the law has the whole compliance
of a linear organ; what its mesh and its law of the tissue cost is in none of them, and many times
that (`sim_server study SCENE`). For another organ: build/release/bin/link_study --scene SCENE
CLIENT DIR (six links).

Writes summary.json into --out. The same bytes each time.

Exit status: 0 done, 1 the program failed, 2 wrong use.
"""

import sys

from one_program import main

sys.exit(main("link_study", __doc__, "two delays, two losses"))
