"""Let plugins whose verbs run in the tick fail in mid-swing: how soon is the machine told to stop?

A mission drives a machine behind the wire in real time. In mid-swing a verb of the estimator, the
odometry, a monitor, the database or the robot raises, hangs, dies, answers late, with
NaN, or with another type, with each runner of jobs (`inline` is refused in real time). Either the
machine is told to stop in time, or the mission goes on as if nothing had been, which is right where
the answer of a verb is of no use.
"""

import sys
from collections.abc import Sequence

from bounds import command_line, verdict

USAGE = """
python tests/benchmarks/tick_cells.py
python tests/benchmarks/tick_cells.py --verbs estimation.state --runners thread
"""
VERBS = (
    "estimation.add_imu",
    "estimation.add_gnss",
    "estimation.add_joints",
    "estimation.state",
    "odometry.add_imu",
    "odometry.add_scan",
    "monitoring.update",
    "objects.stones",
    "robot.read",
)
HOWS = ("raise", "hang", "die", "late", "nan", "wrong_type")
RUNNERS = ("thread", "process")


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    for name, known in (("verbs", VERBS), ("hows", HOWS), ("runners", RUNNERS)):
        parser.add_argument(f"--{name}", nargs="+", choices=known, default=known, metavar="NAME")
    given = parser.parse_args(words)

    from trials.tick_cells import measured

    return verdict(measured(given.verbs, given.hows, given.runners))


if __name__ == "__main__":
    sys.exit(main())
