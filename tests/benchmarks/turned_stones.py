"""Measure whether a stone that turned over is mistaken for one that stands as it did.

One block a scene, drawn by the generator of the simulated sites and at rest on level ground. Its
model is what lidars and a drone saw of it there, without its underside. It is then turned about a
horizontal axis by up to 180° and comes to rest anew, or stays up and is turned by some degrees; the
lidars see it again. The fit is that of the leaves, from a pose that knows nothing of the turn. An
answer is false if it is off by more than 20° or 30 cm. A refusal is right for a stone whose unknown
underside faces up, and is counted for one that stayed up. Two seconds of processor time a scene.
"""

import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = "OMP_NUM_THREADS=1 python tests/benchmarks/turned_stones.py --first 500 --scenes 60"


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--first", type=int, default=1, help="seed of the first scene")
    parser.add_argument("--scenes", type=count, default=60, help="scenes of either kind")
    given = parser.parse_args(words)

    from trials.turned_stones import figures, trial

    seeds = range(given.first, given.first + given.scenes)
    return verdict(figures([trial(seed, turns) for turns in (True, False) for seed in seeds]))


if __name__ == "__main__":
    sys.exit(main())
