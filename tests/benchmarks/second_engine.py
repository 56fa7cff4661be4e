"""Lift the same grasps in MuJoCo and in Bullet, and hold the engines' rankings against each other.

Labels, rehearsals and the simulated world share one engine, so a fault of it would flatter itself.
On each stone the first grasps of the paper's order and the first of the network's are lifted in
both engines, with the same errors of pose, mass and friction (see `LiftTrials`). Bounds: pairs of
grasps of one stone that MuJoCo tells apart have the same order in Bullet, and the network is above
the paper's order in Bullet, too. Bullet is no dependency: `pip install pybullet` first. Twelve
seconds of processor time a stone.
"""

import importlib.util
import sys
from collections.abc import Sequence
from pathlib import Path

from bounds import command_line, count, verdict

USAGE = "python tests/benchmarks/second_engine.py --stones 40 --seed 1 --scans SCANS"


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--stones", type=count, default=40, help="of each kind (default: 40)")
    parser.add_argument("--seed", type=int, default=1, help="seed of stones, views and lifts")
    parser.add_argument("--scans", type=Path, help="folder of scanned stones")
    parser.add_argument(
        "--scenario",
        choices=("kind", "nominal", "wet", "harsh"),
        default="nominal",
        help="whose contacts both engines have (default: nominal)",
    )
    given = parser.parse_args(words)
    if given.scans is not None and not given.scans.is_dir():
        parser.error(f"there is no folder {given.scans}")
    if importlib.util.find_spec("pybullet") is None:
        parser.error("the second engine is not installed: pip install pybullet")

    from trials.second_engine import measured

    return verdict(measured(given.stones, given.seed, given.scans, given.scenario))


if __name__ == "__main__":
    sys.exit(main())
