"""Lay the estimators side by side on a recorded drive: errors against RTK, outages, replay speed.

Without LOG it takes the shared drive beside the project. The bounds are for `dual_graph`: bold
misses its bound, a star marks a stretch that is reached. Speed is in processor seconds. The
inertial noise of the estimators was chosen on the shared drive. Fifteen minutes.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

from bounds import command_line, count, refused, verdict

USAGE = """
python tests/benchmarks/drive_log.py
python tests/benchmarks/drive_log.py LOG.mcap --estimators dual_graph --shifts 1
python tests/benchmarks/drive_log.py LOG.mcap --offset gnss:0.08
"""
LOG = Path(__file__).parents[3] / "shared" / "data" / "estimation" / "drive_0708.mcap"
ESTIMATORS = ("dual_graph", "error_state_ekf", "gnss_imu_filter")


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("log", type=Path, nargs="?", default=LOG, help="a recorded log")
    parser.add_argument(
        "--estimators",
        nargs="+",
        choices=ESTIMATORS,
        default=ESTIMATORS,
        metavar="NAME",
        help=f"of {', '.join(ESTIMATORS)} (default: all)",
    )
    parser.add_argument(
        "--shifts", type=count, default=2, help="passes of outages, shifted against one another"
    )
    parser.add_argument("--offset", action="append", default=[], metavar="SENSOR:SECONDS")
    given = parser.parse_args(words)
    if not given.log.exists():
        parser.error(f"there is no log {given.log}")

    from trials.drive_log import Drive, column, figures, table

    with refused(parser):
        drive = Drive(given.log, tuple(given.offset))
        columns = {name: column(drive, name, given.shifts) for name in given.estimators}
    print(table(columns))
    return verdict(figures(columns))


if __name__ == "__main__":
    sys.exit(main())
