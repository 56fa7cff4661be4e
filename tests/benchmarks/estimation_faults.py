"""Lay the estimators side by side on simulated measurements that go wrong in every way.

Cells show median … worst over the trials, or mean ± standard deviation; bold misses its bound, a
star marks a stretch that is reached; of timings, median … best of blocks of three seconds in which
the estimators take turns. The bounds are for `dual_graph`. The estimators are fed directly, with
default settings but for what a scenario says. An hour for ten seeds; --timing takes three minutes
and is for an idle computer.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

from bounds import command_line, numbers, verdict

USAGE = """
python tests/benchmarks/estimation_faults.py --seeds 1:10
python tests/benchmarks/estimation_faults.py --seeds 1:4 --scenarios spikes ramp \\
    --estimators dual_graph
python tests/benchmarks/estimation_faults.py --keep figures.jsonl    resumes an earlier run
python tests/benchmarks/estimation_faults.py --timing                durations, in real time
"""
ESTIMATORS = ("dual_graph", "error_state_ekf", "gnss_imu_filter")
SCENARIOS = (
    "spikes",
    "plateau",
    "ramp",
    "datum",
    "clean",
    "clean_no_lidar",
    "wander",
    "outage_45",
    "outage_160",
)


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument(
        "--seeds", type=numbers, default=numbers("1:10"), help="such as 3 or 1:10 (default: 1:10)"
    )
    for option, known in (("--scenarios", SCENARIOS), ("--estimators", ESTIMATORS)):
        parser.add_argument(
            option,
            nargs="+",
            choices=known,
            default=known,
            metavar="NAME",
            help=f"of {', '.join(known)} (default: all)",
        )
    parser.add_argument(
        "--keep",
        type=Path,
        help="file of figures, one trial a line; trials in it are not run again",
    )
    parser.add_argument("--timing", action="store_true", help="measure durations instead")
    given = parser.parse_args(words)

    from trials.estimation_faults import faults, timings

    if given.timing:
        return verdict(timings())
    return verdict(faults(given.seeds, given.scenarios, given.estimators, given.keep))


if __name__ == "__main__":
    sys.exit(main())
