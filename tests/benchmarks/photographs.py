"""Go from a drone's photographs to a registered map on simulated sites.

Pictures that find their place, the cloud's distance to the true surface, and whether `segment_fpfh`
and `segment_shot` accept it on a lidar map; camera places, scale, coverage, time and memory are
printed beside. Nothing was tuned on seeds 7000 and up. It needs pycolmap and EGL. Run it with
OMP_NUM_THREADS=1. Three minutes of processor time a site.
"""

import sys
from collections.abc import Sequence

from bounds import add_seeds, command_line, seeds_of, verdict

USAGE = """
OMP_NUM_THREADS=1 python tests/benchmarks/photographs.py 7000:7004
OMP_NUM_THREADS=1 python tests/benchmarks/photographs.py 7004 --noise 1.0
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    add_seeds(parser, "7000:7004")
    parser.add_argument(
        "--noise",
        type=float,
        nargs="+",
        default=[0.5],
        metavar="METRES",
        help="standard deviation of the recorded camera positions (default: 0.5)",
    )
    given = parser.parse_args(words)

    from trials.photographs import measured

    found = []
    for noise_m in given.noise:
        for seed in seeds_of(given):
            found += measured(seed, noise_m)
    return verdict(found)


if __name__ == "__main__":
    sys.exit(main())
