"""Measure whether a stone that stands on two others is recognised, and another one is not.

Three blocks a scene, drawn by the generator of the simulated sites: two side by side on the ground,
and one across them. Models are those of earlier looks at each block alone. The fit is that of the
leaves, `gicp` from where the stone is expected: the map's points of the stones below are left out,
and what is left beside the fitted model has to be likelier of it than of another stone. The wrong
stones have the volume of the right one, and lie flat at its place under eight headings. The same is
measured without these two steps, without a bound. A stone that was put there and is known from two
sides is tried besides, where it stands and where it has rolled over: for it the known surface is
enough.
"""

import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = "python tests/benchmarks/stacked_stones.py --first 500 --scenes 40"


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--first", type=int, default=1, help="seed of the first scene")
    parser.add_argument("--scenes", type=count, default=40, help="number of scenes")
    given = parser.parse_args(words)

    from trials.stacked_stones import figures, trial

    return verdict(figures([trial(given.first + k) for k in range(given.scenes)]))


if __name__ == "__main__":
    sys.exit(main())
