"""Move a drawn block past a swinging lidar, and ask what a segmentation of the map says of it.

For each seed two blocks that stand, and one that comes after three seconds and moves at 0.3 to
1.5 m/s in a drawn direction. A part of which half the points are on the moving block, where it is
at the end, has to be told as moving, and no part on a block that stands. Half a minute of
processor time for ten seeds.
"""

import secrets
import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = """
OMP_NUM_THREADS=1 python tests/benchmarks/moving.py --seeds 40               seeds drawn now
OMP_NUM_THREADS=1 python tests/benchmarks/moving.py --seeds 5 --first 4242   seeds 4242 to 4246
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--seeds", type=count, default=40, help="how many; default: 40")
    parser.add_argument("--first", type=int, help="the first seed; drawn if it is not given")
    given = parser.parse_args(words)
    first = secrets.randbelow(10**8) if given.first is None else given.first

    from trials.moving import measured

    print(f"seeds {first} to {first + given.seeds - 1}", file=sys.stderr, flush=True)
    return verdict(measured(range(first, first + given.seeds)))


if __name__ == "__main__":
    sys.exit(main())
