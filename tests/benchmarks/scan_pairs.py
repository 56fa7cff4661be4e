"""Time what the map takes for a pair of scans, in one simulated swing of 20 s a seed.

The poses are the true ones, so the map alone is measured. Milliseconds are processor time; run it
with OMP_NUM_THREADS=1. A minute a seed.
"""

import secrets
import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = """
OMP_NUM_THREADS=1 python tests/benchmarks/scan_pairs.py --seeds 3               seeds drawn now
OMP_NUM_THREADS=1 python tests/benchmarks/scan_pairs.py --seeds 2 --first 4242  seeds 4242 and 4243
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--seeds", type=count, default=3, help="how many; default: 3")
    parser.add_argument("--first", type=int, help="the first seed; drawn if it is not given")
    given = parser.parse_args(words)
    first = secrets.randbelow(10**8) if given.first is None else given.first

    from trials.scan_pairs import measured

    print(f"seeds {first} to {first + given.seeds - 1}", file=sys.stderr, flush=True)
    return verdict(measured(range(first, first + given.seeds)))


if __name__ == "__main__":
    sys.exit(main())
