"""Compare maps with the map that true poses would have made of the same scans.

`swing`: one swing of 20 s; its measurements are fed to each estimator with each mapper, as they
are, with noisier satellites, and with none after the first seconds. `relocate`: the whole mission
on the pose graph, with the other mapper beside it; the drift is printed after each round of seven.
Drift is the mean displacement of a map's points under the rigid motion that lays the map on the one
of true poses. The bounds on drift are for measurements as they are. Milliseconds are processor
time; run it with OMP_NUM_THREADS=1. Five minutes a swing, an hour a `relocate`.
"""

import sys
from collections.abc import Sequence

from bounds import add_seeds, command_line, seeds_of, verdict

USAGE = """
python tests/benchmarks/mapping.py swing 1:5
python tests/benchmarks/mapping.py relocate 1
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("what", choices=("swing", "relocate"))
    add_seeds(parser)
    given = parser.parse_args(words)

    from trials.mapping import relocations, swings

    seeds = seeds_of(given)
    return verdict(swings(seeds) if given.what == "swing" else relocations(seeds))


if __name__ == "__main__":
    sys.exit(main())
