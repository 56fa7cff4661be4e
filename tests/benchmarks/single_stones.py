"""Look for single stones where they are and where another one is, and count what was accepted.

So many drawn sites of seven stones. A stone's model comes from one swing and a survey; it is
tumbled, and looked for in what another swing shows within 1.8 m of itself and of the next two. An
answer is right if it is off by less than 5 cm and 5°, wherever it was looked for: the next stone
may be within those 1.8 m. The limit of the gate was chosen on 12 other sites. Fifteen seconds of
processor time a site.
"""

import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = "OMP_NUM_THREADS=1 python tests/benchmarks/single_stones.py 12"


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("sites", type=count, nargs="?", default=12, help="default: 12")
    given = parser.parse_args(words)

    from trials.single_stones import counted, figures

    return verdict(figures(counted(given.sites)))


if __name__ == "__main__":
    sys.exit(main())
