"""Hold estimate and map of missions against the truth, with a base that is free to move.

A mission is run and recorded, and the estimator is run on the record. By default the machine sways
on its legs while it surveys a site; with --drive it drives 16 m and scans. The bias of a mission is
the length of the mean error of the cabin's position, and the deviation is the mean of those of its
three components, as in Nubert et al. 2022, Table I. That of the map is the median distance of its
points from the true surface of ground and stones. Half a minute a seed; four with --drive.
"""

import sys
from collections.abc import Sequence

from bounds import add_seeds, command_line, seeds_of, verdict

USAGE = """
python tests/benchmarks/mission_estimates.py 1:4
python tests/benchmarks/mission_estimates.py 1 --drive
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    add_seeds(parser, "1:4")
    parser.add_argument("--drive", action="store_true", help="drive instead of swaying on legs")
    given = parser.parse_args(words)

    from trials.mission_estimates import figures, measured

    return verdict(figures([measured(seed, given.drive) for seed in seeds_of(given)]))


if __name__ == "__main__":
    sys.exit(main())
