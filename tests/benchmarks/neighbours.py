"""Count how many stones are one segment each, by the gap to their neighbour.

Seven stones in three piles, generated and scanned ones, touching, and with gaps of 1 to 30 cm, in
lidar maps and drone surveys. The scans are read from the shared stones beside the
project. The settings were chosen on seeds 8000 to 8002. Five minutes of processor time for ten
scenes.
"""

import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = "OMP_NUM_THREADS=1 python tests/benchmarks/neighbours.py --scenes 10 --first 4242"


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument(
        "--scenes", type=count, default=10, help="for each gap and kind of stones (default: 10)"
    )
    parser.add_argument("--first", type=int, default=7500, help="the first seed (default: 7500)")
    given = parser.parse_args(words)

    from perception.piles import SCANNED
    from trials.neighbours import measured

    if not SCANNED.is_dir():
        parser.error(f"the scanned stones are not in {SCANNED}")
    return verdict(measured(given.scenes, given.first))


if __name__ == "__main__":
    sys.exit(main())
