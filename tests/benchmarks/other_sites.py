"""Segment drawn sites that are not level and hold more than stones.

For each seed: eight stones, up to three of them on crests, on waves of 0.3 m that are 5, 8 and 12 m
long, and on slopes of 12 and 25 degrees; a yard with stones, walls, a boulder, pebbles, a person
and a machine; a street. The settings were chosen on seeds 900, 901 and 1 to 3. Ten seconds of
processor time a seed.
"""

import secrets
import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = """
OMP_NUM_THREADS=1 python tests/benchmarks/other_sites.py --seeds 5                seeds drawn now
OMP_NUM_THREADS=1 python tests/benchmarks/other_sites.py --seeds 5 --first 4242   seeds 4242 to 4246
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--seeds", type=count, default=5, help="how many; default: 5")
    parser.add_argument("--first", type=int, help="the first seed; drawn if it is not given")
    given = parser.parse_args(words)
    first = secrets.randbelow(10**8) if given.first is None else given.first

    from trials.other_sites import measured

    print(f"seeds {first} to {first + given.seeds - 1}", file=sys.stderr, flush=True)
    return verdict(measured(range(first, first + given.seeds)))


if __name__ == "__main__":
    sys.exit(main())
