"""Run a busy mission for an hour on the wall clock: tick intervals, memory, and files.

The cabin of the robot without physics turns to and fro, with a planner in a worker process and an
estimator in the loop, while another branch of the tree goes round at each tick and fills the
journal. Measured are the intervals between ticks, the memory of the process and of its workers from
the tenth minute on, and the room that the run's folder takes. A minute a line tells how it goes.
"""

import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = """
python tests/benchmarks/busy_hour.py
python tests/benchmarks/busy_hour.py --minutes 2 --settled 1
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--minutes", type=count, default=60, help="of the run (default: 60)")
    parser.add_argument(
        "--settled", type=count, default=10, help="minutes until memory may not grow (default: 10)"
    )
    given = parser.parse_args(words)
    if given.settled >= given.minutes:
        parser.error("--settled must be less than --minutes")

    from trials.busy_hour import measured

    return verdict(measured(given.minutes, given.settled))


if __name__ == "__main__":
    sys.exit(main())
