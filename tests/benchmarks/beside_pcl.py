"""Lay registration beside PCL's own parts, on the same segments: time and rate of both.

PCL's chain is ISS, SHOT, geometric consistency and ICP, once with the paper's radii and once with
those of `segment_shot`. It needs g++ and Debian's libpcl-dev. Seeds 2400 and up are drawn here
only. Five minutes of processor time for 12 scenes.
"""

import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = "OMP_NUM_THREADS=1 python tests/benchmarks/beside_pcl.py --scenes 12"


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--scenes", type=count, default=12, help="default: 12")
    given = parser.parse_args(words)

    from trials.pcl import is_installed, measured

    if not is_installed():
        parser.error("PCL or a compiler is missing; install them: apt-get install g++ libpcl-dev")
    return verdict(measured(given.scenes))


if __name__ == "__main__":
    sys.exit(main())
