"""Draw the pictures of docs/grasping.md.

`grasping_costs.png`: the three costs of all grasps of a pool and of the chosen one, for a round and
a flat stone, after Fig. 9 of Mascaro 2020. `grasping_good.png` and `grasping_failed.png`: the first
of some generated stones on which the learned ranking's first grasp lifts in all of four noisy
trials and the paper's ranking's first in none. It fails if no stone is such a one. Run it with
OMP_NUM_THREADS=1. Two minutes.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

from bounds import command_line, count, verdict

IMAGES = Path(__file__).parents[2] / "docs" / "images"
USAGE = "python tests/benchmarks/grasp_figures.py --out docs/images"


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--out", type=Path, default=IMAGES, help="folder (default: docs/images)")
    parser.add_argument("--stones", type=count, default=200, help="to look through (default: 200)")
    given = parser.parse_args(words)

    from trials.grasp_figures import drawn

    given.out.mkdir(parents=True, exist_ok=True)
    return verdict(drawn(given.out, given.stones))


if __name__ == "__main__":
    sys.exit(main())
