"""Count how often the first-ranked grasp of a whole plan lifts, by ranking.

Stones are unseen in training; all rankings get the same clouds, pools and lifts: a free gripper,
noise on pose (±5 cm, ±5°), friction 0.4–0.8 and density 2,300–2,900, four lifts a grasp. SCANS
holds scans [dm]. The bound is for the shipped network above the paper's order. Half an hour for 40
stones.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

from bounds import command_line, count, verdict

USAGE = "python tests/benchmarks/grasp_ranking.py --stones 40 --scans SCANS"


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--stones", type=count, default=40, help="of each kind (default: 40)")
    parser.add_argument("--scans", type=Path, help="folder of scanned stones")
    given = parser.parse_args(words)
    if given.scans is not None and not given.scans.is_dir():
        parser.error(f"there is no folder {given.scans}")

    from trials.grasp_ranking import measured

    return verdict(measured(given.stones, given.scans))


if __name__ == "__main__":
    sys.exit(main())
