"""Measure the object database against the truth over four rounds of relocations.

A stone's database pose should have changed, since it was found, as the stone itself has moved: the
error is what is left between both, in place (of the object's origin) and in rotation. The column
`settled` is before the realignment: how far the stone moved when the jaws let go, and how far
Eq. 3 of Mascaro 2020 is off. The bound is on the pose after the realignment. A seed takes 25
minutes of the mission's time, and less on an idle core.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

from bounds import add_seeds, add_settings, command_line, refused, seeds_of, verdict

USAGE = """
python tests/benchmarks/database_poses.py 2 3               run `relocate`, then measure
python tests/benchmarks/database_poses.py --keep runs 2     the same, and keep the run folders
python tests/benchmarks/database_poses.py --read runs/2     measure a folder that was kept
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    add_seeds(parser)
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="keep the run folders in here")
    parser.add_argument(
        "--read", type=Path, nargs="+", metavar="RUN", help="measure these kept folders instead"
    )
    add_settings(parser)
    given = parser.parse_args(words)
    for folder in given.read or ():
        if not (folder / "truth.npz").is_file():
            parser.error(f"{folder} holds no truth.npz; make it with --keep")

    from trials.database_poses import HEADER, figures, kept, made

    print(HEADER)
    runs = kept(given.read) if given.read else made(seeds_of(given), given.keep, given.settings)
    with refused(parser):
        return verdict(figures(list(runs)))


if __name__ == "__main__":
    sys.exit(main())
