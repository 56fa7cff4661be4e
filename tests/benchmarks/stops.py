"""Press Ctrl-C at random moments of a mission on the wall clock: how soon is the stop commanded?

A thread sends SIGINT to this process at a random moment of a swing. Measured is the time until the
robot's `stop` is called. Each run must end as `stopped`. A quarter of an hour for 1,000 stops.
"""

import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = """
python tests/benchmarks/stops.py --stops 1000
python tests/benchmarks/stops.py --stops 50 --seed 7
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--stops", type=count, default=1000, help="runs (default: 1000)")
    parser.add_argument("--seed", type=int, default=1, help="of the moments (default: 1)")
    given = parser.parse_args(words)

    from trials.stops import measured

    return verdict(measured(given.stops, given.seed))


if __name__ == "__main__":
    sys.exit(main())
