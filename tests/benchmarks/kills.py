"""Kill a mission with signal 9 at random points, resume it, and count what became of the stones.

No stone may be lost, doubled, dropped or misplaced. The machine is one without physics. A kill
takes about three seconds of one core, with its share of the missions; ten minutes for 200.
With `--simulated` each mission runs in the simulated world, once with two kills and once without:
about three minutes of one core.
"""

import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = """
python tests/benchmarks/kills.py --kills 200
python tests/benchmarks/kills.py --kills 10 --seed 7
python tests/benchmarks/kills.py --kills 20 --simulated 7406
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--kills", type=count, default=200, help="number of kills (default: 200)")
    parser.add_argument("--seed", type=int, default=1, help="of the points (default: 1)")
    parser.add_argument(
        "--simulated",
        type=count,
        metavar="SEED",
        help="kill missions in the simulated world instead, of this seed and those after it",
    )
    given = parser.parse_args(words)

    from trials.kills import in_simulation, measured

    if given.simulated is not None:
        return verdict(in_simulation(given.kills, given.seed, given.simulated))
    return verdict(measured(given.kills, given.seed))


if __name__ == "__main__":
    sys.exit(main())
