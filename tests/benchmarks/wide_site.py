"""Segment and register sites of five million points that are a kilometre across.

For each seed: 400 ellipsoids on waves of 0.3 m that are 21 m long, drawn and segmented in a process
of their own, first 200 m across and then 1 km across; and two clouds of the latter registered with
each other. Seconds are processor time of one thread. Half a minute a seed.
"""

import secrets
import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = """
OMP_NUM_THREADS=1 python tests/benchmarks/wide_site.py --seeds 3                seeds drawn now
OMP_NUM_THREADS=1 python tests/benchmarks/wide_site.py --seeds 2 --first 4242   seeds 4242 and 4243
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--seeds", type=count, default=2, help="how many; default: 2")
    parser.add_argument("--first", type=int, help="the first seed; drawn if it is not given")
    given = parser.parse_args(words)
    first = secrets.randbelow(10**8) if given.first is None else given.first

    from trials.wide_site import figures, measured, registered

    print(f"seeds {first} to {first + given.seeds - 1}", file=sys.stderr, flush=True)
    seeds = range(first, first + given.seeds)
    return verdict([*figures(measured(seeds)), *registered(seeds)])


if __name__ == "__main__":
    sys.exit(main())
