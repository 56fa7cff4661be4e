"""Register sites that two motions explain, sites of natural stones, and sites of many stones.

For each seed: a row, a square and a triangle of identical blocks, of which the survey shows another
part than the map, and two sites of seven natural stones, one of them another site. No answer may be
accepted unless it is right. Then 99 stones, right and wrong, once, in a process of their own.
Milliseconds are processor time of one thread. Ten seconds of processor time a seed.
"""

import secrets
import sys
from collections.abc import Sequence
from pathlib import Path

from bounds import command_line, count, verdict

USAGE = """
OMP_NUM_THREADS=1 python tests/benchmarks/twins.py --seeds 20               seeds drawn now
OMP_NUM_THREADS=1 python tests/benchmarks/twins.py --seeds 5 --first 4242   seeds 4242 to 4246
OMP_NUM_THREADS=1 python tests/benchmarks/twins.py --first 4242 --picture twins.png  a picture
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--seeds", type=count, default=10, help="how many; default: 10")
    parser.add_argument("--first", type=int, help="the first seed; drawn if it is not given")
    parser.add_argument("--picture", type=Path, help="draw the first seed's row to a file; end")
    given = parser.parse_args(words)
    first = secrets.randbelow(10**8) if given.first is None else given.first

    if given.picture:
        from trials.twin_picture import pictured

        print(pictured(given.picture, first))
        return 0
    from trials.many_stones import many_stones
    from trials.twins import figures, measured

    print(f"seeds {first} to {first + given.seeds - 1}", file=sys.stderr, flush=True)
    return verdict(figures(measured(range(first, first + given.seeds)), many_stones()))


if __name__ == "__main__":
    sys.exit(main())
