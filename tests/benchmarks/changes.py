"""Compare two clouds of a site before and after: a stone left, one came, one moved, four stayed.

For each seed seven stones and their places are drawn; the one that moved is turned about the
vertical by any angle. Both clouds show the stones all around. Fifteen seconds of processor time for
ten seeds.
"""

import secrets
import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = """
OMP_NUM_THREADS=1 python tests/benchmarks/changes.py --seeds 20               seeds drawn now
OMP_NUM_THREADS=1 python tests/benchmarks/changes.py --seeds 5 --first 4242   seeds 4242 to 4246
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--seeds", type=count, default=10, help="how many; default: 10")
    parser.add_argument("--first", type=int, help="the first seed; drawn if it is not given")
    given = parser.parse_args(words)
    first = secrets.randbelow(10**8) if given.first is None else given.first

    from trials.changes import measured

    print(f"seeds {first} to {first + given.seeds - 1}", file=sys.stderr, flush=True)
    return verdict(measured(range(first, first + given.seeds)))


if __name__ == "__main__":
    sys.exit(main())
