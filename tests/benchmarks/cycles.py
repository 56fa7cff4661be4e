"""Count tipping, flow, limits of joints and collisions in runs that have ended, by the truth.

Each folder is that of a run of the simulated machine, or holds such folders, as that of a campaign
does. A cycle is an attempt at a stone, from the choice of its grasp to the release or to what ended
it. Runs without truth, or of a version that did not observe the limits, are misses, as is a run
that ended because the machine had tipped over.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

from bounds import command_line, count, verdict

USAGE = """
python tests/benchmarks/cycles.py runs
python tests/benchmarks/cycles.py --cycles 70 runs/monday runs/tuesday
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("folders", nargs="+", type=Path, help="folders of runs")
    parser.add_argument(
        "--cycles", type=count, default=500, help="least number of cycles (default: 500)"
    )
    given = parser.parse_args(words)

    from trials.cycles import figures
    from trials.ended import found_in

    reports = found_in(given.folders)
    if not reports:
        parser.error("no report.json in these folders")
    return verdict(figures(reports, given.cycles))


if __name__ == "__main__":
    sys.exit(main())
