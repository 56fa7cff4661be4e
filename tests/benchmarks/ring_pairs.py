"""Lay pairs of drawn scans of few rings over each other, from a guess, beside small_gicp.

Each seed draws a yard with walls and boxes, and two scans of it by a lidar of 32 rings, with noise
along the rays; the guess is 10 cm and 0.3 degrees off, the reach 0.3 m. Both alignment plugins and
small_gicp itself, with their grid and one thread, align the same clouds. Milliseconds are processor
time. With `--pair` the folder's own pair is aligned from drawn guesses as well: small_gicp's
repository has one in `data`, whose motion is an answer of small_gicp, no measurement.
Two seconds of processor time a seed.
"""

import secrets
import sys
from collections.abc import Sequence
from pathlib import Path

from bounds import command_line, count, refused, verdict

USAGE = """
OMP_NUM_THREADS=1 python tests/benchmarks/ring_pairs.py --seeds 12
OMP_NUM_THREADS=1 python tests/benchmarks/ring_pairs.py --seeds 12 --pair small_gicp/data
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--seeds", type=count, default=12, help="how many; default: 12")
    parser.add_argument("--first", type=int, help="the first seed; drawn if it is not given")
    parser.add_argument(
        "--pair", type=Path, help="folder with source.ply, target.ply, T_target_source.txt"
    )
    given = parser.parse_args(words)
    first = secrets.randbelow(10**8) if given.first is None else given.first

    from trials.ring_pairs import drawn_pairs, figures, file_pairs

    seeds = range(first, first + given.seeds)
    print(f"seeds {first} to {first + given.seeds - 1}", file=sys.stderr, flush=True)
    told = figures("drawn scans", drawn_pairs(seeds))
    if given.pair is not None:
        with refused(parser):
            told += figures("the folder's pair", file_pairs(given.pair, seeds))
    return verdict(told)


if __name__ == "__main__":
    sys.exit(main())
