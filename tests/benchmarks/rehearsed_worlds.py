"""Count how often first-ranked grasps lift in each scenario, by what their rehearsals assumed.

The shipped planner plans on each stone four times, with rehearsals that assume `kind`, `nominal`,
`wet` and `harsh`, and otherwise alike. Each first-ranked grasp is then lifted by a free gripper
with the contacts of the world, under noise of pose, friction and density (see `grasp_ranking.py`).
A plan without a grasp lifts nothing, and drops nothing. The bound is that rehearsals with the
world's own contacts do not lift less often than those that assume `kind`. Five seconds of processor
time a stone.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

from bounds import command_line, count, verdict

USAGE = "python tests/benchmarks/rehearsed_worlds.py --stones 40 --seed 1 --scans SCANS"


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--stones", type=count, default=40, help="of each kind (default: 40)")
    parser.add_argument("--seed", type=int, default=1, help="seed of stones, views and lifts")
    parser.add_argument("--scans", type=Path, help="folder of scanned stones")
    given = parser.parse_args(words)
    if given.scans is not None and not given.scans.is_dir():
        parser.error(f"there is no folder {given.scans}")

    from trials.rehearsed_worlds import measured

    return verdict(measured(given.stones, given.seed, given.scans))


if __name__ == "__main__":
    sys.exit(main())
