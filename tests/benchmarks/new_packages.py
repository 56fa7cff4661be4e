"""Make a package of each capability as a user does, and use them in missions.

The wheel is built from a clone of the last commit and installed into a new virtual environment.
There, `executive plugins new` writes a package for each capability and a leaf, pip installs each,
`executive plugins test` holds each to its contract, and two missions with these packages run to
their ends. Foreign packages called `plugins`, `trees` and `robot_models` lie on the path and raise
when they are imported. pip takes packages from where it is told to (PIP_FIND_LINKS).
"""

import sys
from collections.abc import Sequence
from pathlib import Path

from bounds import command_line, verdict

USAGE = """
python tests/benchmarks/new_packages.py
python tests/benchmarks/new_packages.py --folder /tmp/packages
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument(
        "--folder",
        type=Path,
        help="new folder that is kept, with the environment, the packages and the run's folder",
    )
    given = parser.parse_args(words)
    if given.folder is not None and given.folder.exists():
        parser.error(f"{given.folder} exists already: name a new folder")

    from trials.new_packages import measured

    return verdict(measured(given.folder))


if __name__ == "__main__":
    sys.exit(main())
