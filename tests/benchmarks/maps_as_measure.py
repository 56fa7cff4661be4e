"""Build the site's map with each estimator's poses through an outage of the satellites.

After Nubert 2022, Fig. 5: a map is as sharp as the poses that its scans were placed by. The cabin
swings for 20 s with the lidars on; three seconds into that the satellites are lost for good. Then
the same without the chassis' inertial sensor, so that nothing tells that the chassis is at rest.
Figures are distances of the map's points to the true surface of ground and stones. The bound is
for `dual_graph`. Four minutes a seed on an idle core.
"""

import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from bounds import add_seeds, command_line, seeds_of, verdict

USAGE = "python tests/benchmarks/maps_as_measure.py 1 --picture docs/images/estimation_maps.png"


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    add_seeds(parser)
    parser.add_argument(
        "--picture", type=Path, metavar="PNG", help="draw the first seed's maps into this file"
    )
    given = parser.parse_args(words)

    from trials.maps_as_measure import HEADER, figures, measured, picture

    print(HEADER, flush=True)
    found = []
    for i, seed in enumerate(seeds_of(given)):
        with tempfile.TemporaryDirectory() as folder:
            maps, surface = measured(seed, Path(folder))
        found += figures(seed, maps, surface)
        if given.picture is not None and i == 0:
            picture(given.picture, maps, surface)
    return verdict(found)


if __name__ == "__main__":
    sys.exit(main())
