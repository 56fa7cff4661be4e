"""Compare the models of surveyed stones with their true hulls: volume, sides and underside.

FOLDERS are runs of `tests/benchmarks/trials/survey_alone.yaml`, which maps a site, registers the
drone's survey and ends before the first grasp. A support is how far a hull reaches in a direction;
sides are directions within 24° of level, the underside those 24° to 58° below it.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

from bounds import command_line, verdict

USAGE = """
executive run tests/benchmarks/trials/survey_alone.yaml --seed 4242 --run-dir FOLDER
OMP_NUM_THREADS=1 python tests/benchmarks/known_stones.py FOLDER
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("folders", type=Path, nargs="+", help="folders of runs")
    given = parser.parse_args(words)
    for folder in given.folders:
        if not (folder / "map.ply").is_file():
            parser.error(f"{folder} is no run of survey_alone.yaml: it has no map.ply")

    from trials.known_stones import measured

    return verdict(measured(given.folders))


if __name__ == "__main__":
    sys.exit(main())
