"""Measure the planner of dry-stone structures alone: no machine, releases with noise.

A wall of 6 × 1.3 × 1.5 m is built in a trial of 40 stones a seed: scans at scale 8, drawn by the
seed, a quarter of them replaced by generated blocks. A stone is right if it settles within 10 cm
and 10° of its plan. Any legal drop is a stone in any rotation, let down at any place where it
touches others first and is in the envelope, onto the same wall as it stood at times, without a
score, a support below the centre of mass, or a check.

With `--as-known` the stones are 20 scans (`--scans`) as they lie, and the planner is that of
`build_wall` and knows what a mission does: hulls, with room, and where the last look saw those
that stand. Twelve are asked for then, 90 % of them right.
"""

import json
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from bounds import command_line, count, refused, verdict

STONES = Path(__file__).parents[3] / "shared" / "data" / "stones"
USAGE = """
python tests/benchmarks/wall_planner.py --first 200
python tests/benchmarks/wall_planner.py --first 300 --seeds 2 --drops 0 --without-judge
python tests/benchmarks/wall_planner.py --first 400 --as-known --drops 0 --without-judge
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--first", type=int, default=200, help="first seed")
    parser.add_argument("--seeds", type=count, default=5, help="number of seeds")
    parser.add_argument("--drops", type=int, default=6, help="legal drops a seed, to compare")
    parser.add_argument("--most", type=count, default=24, help="stones after which a wall ends")
    parser.add_argument("--stones", type=Path, default=STONES, help="folder of scans")
    parser.add_argument("--budget", type=float, default=25.0, help="processor time a plan [s]")
    parser.add_argument("--jobs", type=count, default=2, help="walls that are built at a time")
    parser.add_argument("--as-known", action="store_true", help="with what a mission knows")
    parser.add_argument("--scans", type=count, default=20, help="scans with --as-known")
    parser.add_argument("--without-judge", action="store_true", help="fill and joints alone")
    parser.add_argument("--keep", type=Path, default=None, help="folder for a JSON file a seed")
    given = parser.parse_args(words)

    from trials.wall_planner import Job, figures, wall

    if given.keep is not None:  # now, and not after the first wall
        given.keep.mkdir(parents=True, exist_ok=True)
    with refused(parser):
        jobs = [
            Job(seed, given.stones, given.most, given.drops, given.budget,
                not given.without_judge, given.keep, given.scans if given.as_known else None)
            for seed in range(given.first, given.first + given.seeds)
        ]  # fmt: skip
        with ProcessPoolExecutor(given.jobs) as pool:
            found = list(pool.map(wall, jobs))
    for one in found:
        print(json.dumps({k: v for k, v in one.items() if k != "stones"}), flush=True)
    return verdict(figures(found, given.as_known))


if __name__ == "__main__":
    sys.exit(main())
