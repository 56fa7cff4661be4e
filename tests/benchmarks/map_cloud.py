"""Read the cloud of a map of 450,000 voxels after scan pairs, and its density.

For each seed: ground with 30 stones within 10 m is drawn and put into a map; then pairs of two
lidars of 16 rings are added, and the cloud is read after each, and after each five. Milliseconds
are processor time of one thread. Ten seconds of processor time for five seeds.
"""

import secrets
import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = """
OMP_NUM_THREADS=1 python tests/benchmarks/map_cloud.py --seeds 5                seeds drawn now
OMP_NUM_THREADS=1 python tests/benchmarks/map_cloud.py --seeds 5 --first 4242   seeds 4242 to 4246
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--seeds", type=count, default=5, help="how many; default: 5")
    parser.add_argument("--first", type=int, help="the first seed; drawn if it is not given")
    given = parser.parse_args(words)
    first = secrets.randbelow(10**8) if given.first is None else given.first

    from trials.map_cloud import measured

    print(f"seeds {first} to {first + given.seeds - 1}", file=sys.stderr, flush=True)
    return verdict(measured(range(first, first + given.seeds)))


if __name__ == "__main__":
    sys.exit(main())
