"""Calibrate drawn logs whose sensors are declared wrongly: clocks, lever arms and mounting.

Each log's receiver and odometry get a clock that is off by up to 0.2 s, lever arms that are
declared wrongly by 0.2 m (one standard deviation), and a mounting turned by 0.05 rad. What the
calibration says is found must be right; what it says is not, the log does not show. A log of 90 s
takes 3 to 30 s.
"""

import sys
from collections.abc import Sequence

from bounds import add_seeds, command_line, count, refused, seeds_of, verdict

USAGE = """
python tests/benchmarks/calibration.py 6400:6423
python tests/benchmarks/calibration.py 6400:6403 --each
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    add_seeds(parser, "1:12")
    parser.add_argument("--duration", type=count, default=90, help="length of a log [s]")
    parser.add_argument("--each", action="store_true", help="print a line for each quantity")
    given = parser.parse_args(words)

    from trials.calibration import figures, trials

    with refused(parser):
        found = trials(seeds_of(given), given.duration, given.each)
    return verdict(figures(found))


if __name__ == "__main__":
    sys.exit(main())
