"""Measure what checking costs: trees of many nodes, and the command on a shipped mission.

The trees are sequences of `set`, `wait` and `check` nodes with conditions on keys. Times are
processor times, the shortest of at least three. Run it with OMP_NUM_THREADS=1. One minute.
"""

import sys
from collections.abc import Sequence

from bounds import command_line, verdict

USAGE = """
python tests/benchmarks/check_cost.py
python tests/benchmarks/check_cost.py --nodes 500 5000
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument(
        "--nodes",
        type=int,
        nargs="+",
        choices=(500, 5_000, 20_000, 100_000),
        default=[500, 5_000, 20_000, 100_000],
        help="Sizes of the trees.",
    )
    given = parser.parse_args(words)

    from trials.check_cost import commands, trees

    # The commands first: the memory of a child counts that of the process that it is made from.
    told = list(commands())
    return verdict([*trees(given.nodes), *told])


if __name__ == "__main__":
    sys.exit(main())
