"""Compare the chance that missions expected of first attempts with what came of them, by the truth.

Each folder is that of a run of the simulated machine, or holds such folders, as that of a campaign
does. A first attempt at a stone has succeeded if it is the only one and the stone is near its slot
at the end. The calibration error is the mean distance of what was expected from what came, over
four bins (below 60, 80, 90 and 100 %), weighted by the attempts in each (Naeini et al. 2015). Runs
without truth, or in which nothing was expected, are misses.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

from bounds import command_line, count, verdict

USAGE = """
python tests/benchmarks/predicted_success.py campaign/runs
python tests/benchmarks/predicted_success.py --attempts 70 runs/monday runs/tuesday
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("folders", nargs="+", type=Path, help="folders of runs")
    parser.add_argument(
        "--attempts", type=count, default=70, help="least number of a world (default: 70)"
    )
    given = parser.parse_args(words)

    from trials.ended import found_in
    from trials.predicted_success import figures

    reports = found_in(given.folders)
    if not reports:
        parser.error("no report.json in these folders")
    return verdict(figures(reports, given.attempts))


if __name__ == "__main__":
    sys.exit(main())
