"""Run whole missions over seeds: one line a seed, then the bounds.

Near is a stone within 0.30 m of the middle of its slot, by the simulator's truth. The speed is
bounded on two idle cores; a busy computer misses it. Two minutes a seed on an idle core.
"""

import sys
from collections.abc import Sequence

from bounds import add_seeds, add_settings, command_line, refused, seeds_of, verdict

USAGE = """
python tests/benchmarks/missions.py 1:5
python tests/benchmarks/missions.py 1 --set robot.site.stones.count=1
python tests/benchmarks/missions.py 1:3 --set robot.site.stones.folder=SCANS \\
    --set robot.site.stones.scale=10
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    add_seeds(parser)
    parser.add_argument("--mission", default="pick_and_place", help="default: pick_and_place")
    add_settings(parser)
    given = parser.parse_args(words)

    from trials.missions import HEADER, figures, run

    print(HEADER, flush=True)
    outcomes = []
    with refused(parser):
        for outcome in run(given.mission, seeds_of(given), given.settings):
            outcomes.append(outcome)
            print(outcome.line(), flush=True)
    are_scanned = any(one.startswith("robot.site.stones.folder=") for one in given.settings)
    return verdict(figures(outcomes, are_scanned))


if __name__ == "__main__":
    sys.exit(main())
