"""Run the mapping mission over seeds and tell when the drone's map was first registered.

Times are the mission's, from the first movement of the swing. The paper's first success came after
15 s (Mascaro 2020, Sec. 6.2). Run it with OMP_NUM_THREADS=1. Fifteen seconds of processor time a
seed.
"""

import sys
from collections.abc import Sequence

from bounds import add_seeds, add_settings, command_line, refused, seeds_of, verdict

USAGE = """
python tests/benchmarks/first_success.py 101:120
python tests/benchmarks/first_success.py 1:3 --set registration.plugin=segment_fpfh
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    add_seeds(parser)
    add_settings(parser)
    given = parser.parse_args(words)

    from trials.first_success import HEADER, figures, measured

    print(HEADER, flush=True)
    with refused(parser):
        return verdict(figures(*measured(seeds_of(given), given.settings)))


if __name__ == "__main__":
    sys.exit(main())
