"""Kill or freeze whole runs on the wall clock, and measure when their machines come to rest.

Each trial starts `executive run --real-time`, whose simulated machine lives in a process of its
own. In mid-swing the executive and its supervisor are killed (`kill`) or stopped (`freeze`) at a
random moment, so that nobody is left to tell the machine. The stop has to begin within 0.3 s, and
the machine to stand within its longest stop after that. A trial takes a quarter of a minute.
"""

import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = """
python tests/benchmarks/orphans.py --trials 20
python tests/benchmarks/orphans.py --trials 4 --seed 13101
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--trials", type=count, default=20, help="of both kinds together")
    parser.add_argument("--seed", type=int, default=1, help="of the moments")
    given = parser.parse_args(words)

    from trials.orphans import measured

    return verdict(measured(given.trials, given.seed))


if __name__ == "__main__":
    sys.exit(main())
