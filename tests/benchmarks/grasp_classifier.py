"""Measure how well the shipped networks tell grasps that lift from others, and what they pick.

Each grasp is lifted eight times, each time with noise of its own on pose, friction and density. A
single lift is partly chance: the `ceiling` is the area under the curve (AUC) of a judge who knows
the other seven lifts. `usual` asks whether most of the eight succeed, which is what a planner wants
to know. Picked from the same grasps of a stone, half of them the paper's first: the paper's first,
and the one of the highest predicted success. Stones are unseen in training; SCANS holds scans [dm].
Intervals of 95 % by bootstrap over stones. The bounds are for `two_stream_kind`, which has learned
from lifts in `kind` as these are. An hour for 60 stones.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

from bounds import command_line, count, refused, verdict

USAGE = "python tests/benchmarks/grasp_classifier.py --stones 60 --scans SCANS"
WEIGHTS = ("two_stream_kind", "four_layer")  # which learned from such lifts


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--stones", type=count, default=60, help="of each kind (default: 60)")
    parser.add_argument("--scans", type=Path, help="folder of scanned stones")
    parser.add_argument("--weights", nargs="+", default=list(WEIGHTS), help="names or files")
    given = parser.parse_args(words)
    if given.scans is not None and not given.scans.is_dir():
        parser.error(f"there is no folder {given.scans}")

    from trials.grasp_classifier import measured

    with refused(parser):
        return verdict(measured(given.stones, given.scans, given.weights))


if __name__ == "__main__":
    sys.exit(main())
