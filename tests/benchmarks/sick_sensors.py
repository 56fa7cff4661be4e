"""One sensor of a drawn log is wrong, late, silent or jumps for some seconds; all others are sound.

Counts the trials in which an estimator says GLOBAL while its position is outside three standard
deviations of its own covariance for longer than 3 s, and the time until it is inside again.
The faults of one log share its sound first 25 s; a trial takes 1 to 8 s.
"""

import sys
from collections.abc import Sequence

from bounds import add_jobs, add_seeds, command_line, refused, seeds_of, verdict

USAGE = """
python tests/benchmarks/sick_sensors.py 1:5
python tests/benchmarks/sick_sensors.py 1 --kinds "fixes: jump" --each
python tests/benchmarks/sick_sensors.py 1 --kinds odometry --estimator dual_graph
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    add_seeds(parser, "1")
    parser.add_argument("--estimator", default="gnss_imu_filter", metavar="NAME")
    parser.add_argument("--kinds", default="", metavar="TEXT", help="those whose name begins so")
    parser.add_argument("--each", action="store_true", help="print a line for each trial")
    add_jobs(parser)
    given = parser.parse_args(words)

    from trials.sick_sensors import figures, kinds, run

    chosen = kinds(given.kinds)
    if not chosen:
        parser.error(f"no kind begins with {given.kinds!r}")
    with refused(parser):
        trials = run(chosen, seeds_of(given), given.estimator, given.each, given.jobs)
    return verdict(figures(trials))


if __name__ == "__main__":
    sys.exit(main())
