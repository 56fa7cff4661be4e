"""Lay the estimators and a plain GTSAM smoother side by side on logs that are drawn at random.

Bodies (on foot, car, flyer, excavator), motions, rates, noise, biases, clocks and lever arms are
drawn widely from each seed, so that no constant of an estimator fits them by luck. A log of 90 s
takes 5 to 60 s for each estimator. The bounds are for the estimator named by --held.
"""

import sys
from collections.abc import Sequence

from bounds import add_jobs, add_seeds, command_line, count, refused, seeds_of, verdict

USAGE = """
python tests/benchmarks/unseen_logs.py 1000:1299
python tests/benchmarks/unseen_logs.py 5:8 --estimators gnss_imu_filter plain_smoother --each
python tests/benchmarks/unseen_logs.py 5:8 --estimators gnss_imu_filter plain_smoother --outage 10
"""
ESTIMATORS = ("gnss_imu_filter", "error_state_ekf", "dual_graph", "plain_smoother")


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    add_seeds(parser, "1:20")
    parser.add_argument(
        "--estimators",
        nargs="+",
        choices=ESTIMATORS,
        default=ESTIMATORS,
        metavar="NAME",
        help=f"of {', '.join(ESTIMATORS)} (default: all)",
    )
    parser.add_argument("--held", choices=ESTIMATORS, default="gnss_imu_filter", metavar="NAME")
    parser.add_argument("--duration", type=count, default=90, help="length of a log [s]")
    parser.add_argument(
        "--outage", type=count, metavar="S", help="no fixes for so long from second 30 on [s]"
    )
    parser.add_argument("--each", action="store_true", help="print a line for each log")
    add_jobs(parser)
    given = parser.parse_args(words)
    if given.held not in given.estimators:
        parser.error(f"--held {given.held} is not among --estimators")

    from trials.unseen_logs import columns, figures, table

    with refused(parser):
        found = columns(
            seeds_of(given),
            given.estimators,
            given.duration,
            given.outage or 0,
            given.each,
            given.jobs,
        )
    print(table(found))
    return verdict(figures(found, given.held))


if __name__ == "__main__":
    sys.exit(main())
