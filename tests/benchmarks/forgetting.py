"""Take a drawn block away before a swinging lidar, and count what a map keeps of it.

For each seed a block and its place, another that stays, and one hidden behind that one are drawn.
The map sees them for 50 scan pairs, then the first is taken away. Of it, what is more than 25 cm
above the ground counts: lower, rays end on the ground before they have passed. Half a minute of
processor time for ten seeds.
"""

import secrets
import sys
from collections.abc import Sequence
from pathlib import Path

from bounds import command_line, count, verdict

USAGE = """
OMP_NUM_THREADS=1 python tests/benchmarks/forgetting.py --seeds 20               seeds drawn now
OMP_NUM_THREADS=1 python tests/benchmarks/forgetting.py --seeds 5 --first 4242   seeds 4242 to 4246
OMP_NUM_THREADS=1 python tests/benchmarks/forgetting.py --first 4242 --picture map.png  a picture
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--seeds", type=count, default=10, help="how many; default: 10")
    parser.add_argument("--first", type=int, help="the first seed; drawn if it is not given")
    parser.add_argument("--picture", type=Path, help="draw the first seed's map to a file; end")
    given = parser.parse_args(words)
    first = secrets.randbelow(10**8) if given.first is None else given.first

    from trials.forgetting import measured, pictured

    if given.picture:
        print(pictured(given.picture, first))
        return 0
    print(f"seeds {first} to {first + given.seeds - 1}", file=sys.stderr, flush=True)
    return verdict(measured(range(first, first + given.seeds)))


if __name__ == "__main__":
    sys.exit(main())
