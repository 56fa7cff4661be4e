"""Compare networks by what they foretell of lifts in a scenario, and by what their choices hold.

Each network plans on the same stones, with rehearsals that assume the scenario of the world. The
first eight grasps of every network, eight more of the pool, half of them the paper's first and half
random, and the first choices after rehearsal are lifted four times each by a free gripper, with the
true hull, the errors that the planner assumes (2 cm, 1.5°), and the friction and density of labels:
the same four draws for every grasp of a stone. Brier score and expected calibration error (ten bins
of width 0.1) are of all of these grasps but the last; they are the same for all networks. Intervals
of 95 % by bootstrap over stones. SITES are folders of runs of `trials/survey_alone.yaml`, whose
stones are as a mission knows them at its first plan; without, stones are generated and seen as the
training data have them. The bound is on the last network of WEIGHTS: what it predicts of its first
choices is not more than 15 points above what holds. Eight seconds of processor time a stone.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

from bounds import command_line, count, refused, verdict

WORLDS = ("kind", "nominal", "wet", "harsh")
USAGE = "python tests/benchmarks/grasp_calibration.py --weights two_stream my.safetensors"


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--weights", nargs="+", default=["two_stream"], help="names or files")
    parser.add_argument(
        "--world", choices=WORLDS, default="nominal", help="of lifts and rehearsals"
    )
    parser.add_argument("--stones", type=count, default=60, help="generated ones (default: 60)")
    parser.add_argument("--seed", type=int, default=1, help="seed of stones, views and lifts")
    parser.add_argument("--sites", type=Path, nargs="+", default=[], help="folders of runs")
    parser.add_argument("--soil", type=float, help="how far tips go into soil [m] (default: 0.1)")
    given = parser.parse_args(words)
    for folder in given.sites:
        if not (folder / "objects.sqlite").is_file():
            parser.error(f"{folder} holds no stones of a run")

    from trials.grasp_calibration import measured

    with refused(parser):
        return verdict(measured(**vars(given)))


if __name__ == "__main__":
    sys.exit(main())
