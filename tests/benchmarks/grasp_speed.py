"""Measure how long a plan takes, how many hypotheses are checked, and whether grasps are free.

Generated stones as two lidars of a swinging cabin and, half of them, a drone see them; 100 samples
of 40 orientations; planning clouds of about 15,000 points. The rate counts only hypotheses that
are pushed and closed, not those that are too steep. Refusals are timed on the same stones, made too
wide or too heavy. FCL says of every grasp that is returned whether palm or open jaws are deeper
than 1 cm in the planning cloud. Times are CPU time of one core: run it with OMP_NUM_THREADS=1.
Three minutes for 16 stones.
"""

import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = "OMP_NUM_THREADS=1 python tests/benchmarks/grasp_speed.py 40"


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("stones", type=count, nargs="?", default=40, help="default: 40")
    given = parser.parse_args(words)

    from trials.grasp_speed import measured

    return verdict(measured(given.stones))


if __name__ == "__main__":
    sys.exit(main())
