"""Hold planned motions against the limits of their joints, and their times against toppra's.

Picks (empty) and placements (loaded) of stones on drawn sites, from where the last motion ended,
and postures drawn at random between them. Each trajectory is evaluated every millisecond; velocity,
acceleration and jerk are its first three finite differences. The time is compared with that of
toppra on the planned motion's own path, under the same velocity and acceleration limits and without
jerk; toppra is no dependency, and where it is not installed the comparison is told as not made.
Times of planning are processor times. Run it with OMP_NUM_THREADS=1. Half a second
a path.
"""

import sys
from collections.abc import Sequence

from bounds import add_seeds, command_line, count, seeds_of, verdict

USAGE = """
python tests/benchmarks/path_limits.py
python tests/benchmarks/path_limits.py 51:60 --machine mini --paths 100
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    add_seeds(parser, "1:100")
    parser.add_argument("--machine", default="m545", help="the machine (default: m545)")
    parser.add_argument(
        "--paths", type=count, default=1000, help="largest number of paths (default: 1000)"
    )
    given = parser.parse_args(words)

    from trials.path_limits import figures, measured

    return verdict(figures(measured(given.machine, seeds_of(given), given.paths)))


if __name__ == "__main__":
    sys.exit(main())
