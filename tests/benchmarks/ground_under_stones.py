"""Compare the motion planner's ground with the true one, about stones, in the first map of a site.

One line a seed: of the area within 1.2 m of a stone, the share that is estimated more than 5 cm too
high, where paths are refused that are free, and more than 10 cm too low, where jaws would dig; and
the same for the lowest point of half a metre, which is the nearest simple method. Run it with
OMP_NUM_THREADS=1. Half a minute a seed.
"""

import sys
from collections.abc import Sequence

from bounds import add_seeds, add_settings, command_line, refused, seeds_of, verdict

USAGE = """
python tests/benchmarks/ground_under_stones.py 7 8 21:23
python tests/benchmarks/ground_under_stones.py 21:23 --set robot.site.terrain.undulation_m=0.2
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    add_seeds(parser)
    add_settings(parser)
    given = parser.parse_args(words)

    from trials.ground_under_stones import HEADER, figures, measured

    print(HEADER, flush=True)
    sites = []
    with refused(parser):
        for seed in seeds_of(given):
            sites.append(measured(seed, given.settings))
            print(sites[-1], flush=True)
    has_waves = any(one.startswith("robot.site.terrain.") for one in given.settings)
    return verdict(figures(sites, has_waves))


if __name__ == "__main__":
    sys.exit(main())
