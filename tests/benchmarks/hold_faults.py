"""Measure how soon the monitor of a hold tells falls and slips, how often it is wrong, and how well
it weighs.

Stones of generated sites are gripped, lifted for a trial and carried by the simulated arm with its
encoders, without lidars. Three in four holds get a fault in mid-carry, one after the other: the
jaws lose their pressure, a valve opens them, the stone becomes slippery. The mission does not
react, so that the simulator's truth says what came of each. Faults count where the stone had not
moved for a second and nothing was told before; a slip begins where it has moved by 3 cm in the jaws
since. Stones that are lost without a fault, or before it, were badly gripped: the trial or the
monitor has to tell them. Seven seconds of processor time a hold; 400 holds give the bounds their
meaning.
"""

import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = "OMP_NUM_THREADS=1 python tests/benchmarks/hold_faults.py --sites 58"


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument(
        "--sites", type=count, default=58, help="number of sites of seven stones (default: 58)"
    )
    parser.add_argument("--first", type=count, default=9000, help="first site (default: 9000)")
    given = parser.parse_args(words)

    from trials.hold_faults import measured

    return verdict(measured(range(given.first, given.first + given.sites)))


if __name__ == "__main__":
    sys.exit(main())
