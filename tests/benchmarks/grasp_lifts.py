"""Count how often the grasps of whole missions succeed, with what the sensors saw.

Each site is one `pick_and_place` of seven stones: seeds 1001, 1002, … of generated ones, or seven
scans of a folder SCANS, in an order of seed 0, none twice, those left out that are heavier than the
payload. Rankings see the same sites. FOLDER/lifts.jsonl gets a line a stone; sites that are there
already are skipped: a run goes on where it stopped.

An attempt is a success if the mission says that the stone was placed and the simulator that it was
lifted and not dropped: picked up, carried to its slot, set down. Stones that were found and for
which there was no attempt count as failures. Intervals: Wilson, 95 %. The bounds are for the
learned ranking. Two minutes a site on an idle core.
"""

import sys
from collections.abc import Sequence

from bounds import verdict
from grasp_sites import read

USAGE = """
python tests/benchmarks/grasp_lifts.py FOLDER run generated learned 1:15
python tests/benchmarks/grasp_lifts.py FOLDER run SCANS learned 1:5 --scale 10
python tests/benchmarks/grasp_lifts.py FOLDER table
"""


def main(words: Sequence[str] | None = None) -> int:
    given, path = read(__doc__, USAGE, "lifts.jsonl", words)

    from trials import grasp_lifts

    if given.verb == "run":
        sites_run = grasp_lifts.sites_run
        rows = sites_run(path, given.stones, given.ranking, given.scale, given.sites)
    else:
        rows = grasp_lifts.read(path)
    print(grasp_lifts.table(rows))
    return verdict(grasp_lifts.figures(rows))


if __name__ == "__main__":
    sys.exit(main())
