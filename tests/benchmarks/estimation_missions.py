"""Lay the estimators side by side on simulated missions with a swinging cabin.

Each seed is run once and recorded; scans become increments once. Three conditions are cut from that
log: all sensors; outages of the satellites of 45 s and 160 s; and the same without the chassis'
inertial sensor, so that nothing tells that the chassis is at rest and lidar alone carries the
estimate. The bounds are for `dual_graph`. Ten minutes a seed on an idle core.
"""

import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from bounds import add_seeds, command_line, seeds_of, verdict

USAGE = """
python tests/benchmarks/estimation_missions.py 1:3
python tests/benchmarks/estimation_missions.py 1 --plot docs/images/estimation_outages.png
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    add_seeds(parser)
    parser.add_argument(
        "--plot", type=Path, metavar="PNG", help="draw the first seed's outages into this file"
    )
    given = parser.parse_args(words)

    from trials.estimation_missions import compared, figures, plot, recorded

    found = []
    for i, seed in enumerate(seeds_of(given)):
        with tempfile.TemporaryDirectory() as folder:
            rehearsal, material = recorded(seed, Path(folder))
            reports, curves = compared(rehearsal, material, seed)
        found += figures(seed, reports)
        if given.plot is not None and i == 0:
            plot(given.plot, curves)
            print(given.plot, file=sys.stderr)
    return verdict(found)


if __name__ == "__main__":
    sys.exit(main())
