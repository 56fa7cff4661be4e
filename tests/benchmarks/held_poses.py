"""Measure how well the pose of a stone in the jaws is known, before and after a look at it.

Each stone of a site is grasped, raised past the lidars by the shipped subtrees, and set down where
it was. The pose in the jaws that the database has is compared with the simulator's, before the look
and after it; a look that is refused leaves the expected pose, which counts as it is.
"""

import sys
from collections.abc import Sequence

from bounds import add_seeds, add_settings, command_line, count, refused, seeds_of, verdict

USAGE = """
python tests/benchmarks/held_poses.py 1:3
python tests/benchmarks/held_poses.py 4 --stones 6 --set robot.scenario=wet
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    add_seeds(parser)
    parser.add_argument("--stones", type=count, default=6, help="stones of each site")
    add_settings(parser)
    given = parser.parse_args(words)

    from trials.held_poses import figures, looks

    found = []
    with refused(parser):
        for seed in seeds_of(given):
            for look in looks(seed, given.stones, given.settings):
                found.append(look)
                print(f"seed {seed}, {look}", flush=True)
    return verdict(figures(found))


if __name__ == "__main__":
    sys.exit(main())
