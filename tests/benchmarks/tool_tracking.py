"""Hold the tool of a hydraulic arm against the path that it shall follow.

Picks (empty) and placements (with a stone's mass at the palm) on drawn sites, as in
`path_limits.py`, followed by the simulated machine with `drive: hydraulic`; each seed has valves of
its own. The error is the distance of the grasp centre from where the reference was one dead time
before; that delay of the whole motion is told apart. At the goal it is read one second after the
reference has ended. Four seconds of processor time a path.
"""

import sys
from collections.abc import Sequence

from bounds import add_seeds, command_line, count, seeds_of, verdict

USAGE = """
python tests/benchmarks/tool_tracking.py 1:20
python tests/benchmarks/tool_tracking.py 1:20 --drive servo
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    add_seeds(parser, "1:20")
    parser.add_argument(
        "--paths", type=count, default=4, help="largest number of paths a seed (default: 4)"
    )
    parser.add_argument(
        "--drive", choices=("hydraulic", "servo"), default="hydraulic", help="the drive of the arm"
    )
    given = parser.parse_args(words)

    from trials.tool_tracking import figures, measured

    return verdict(figures(measured(seeds_of(given), given.paths, given.drive == "hydraulic")))


if __name__ == "__main__":
    sys.exit(main())
