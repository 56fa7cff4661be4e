"""Register sites that are hard in one respect each: little overlap, noise, outliers, tilt, slope.

For each seed six sites: the usual one of seven stones; 30 % overlap with four whole stones in it;
twice the noise; a tenth of the points strewn at random; a survey tilted by 20 degrees; a slope of
12 degrees. Right is an error below 5 cm and 1 degree. Milliseconds are processor time of one
thread. Eight seconds of processor time a seed.
"""

import secrets
import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = """
OMP_NUM_THREADS=1 python tests/benchmarks/hard_sites.py --seeds 20               seeds drawn now
OMP_NUM_THREADS=1 python tests/benchmarks/hard_sites.py --seeds 5 --first 4242   seeds 4242 to 4246
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--seeds", type=count, default=10, help="how many; default: 10")
    parser.add_argument("--first", type=int, help="the first seed; drawn if it is not given")
    given = parser.parse_args(words)
    first = secrets.randbelow(10**8) if given.first is None else given.first

    from trials.hard_sites import figures, measured

    print(f"seeds {first} to {first + given.seeds - 1}", file=sys.stderr, flush=True)
    return verdict(figures(measured(range(first, first + given.seeds))))


if __name__ == "__main__":
    sys.exit(main())
