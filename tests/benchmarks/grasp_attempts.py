"""Count how often grasps lift, carry by 90° and set down, with the machine's own arm and jaws.

Some ten times faster than missions (`docs/campaigns/grasp_planners.yaml`): what replaces the
mission's lidars, mapping and estimation is a made-up view of each stone and its neighbours (half of
the scenes with a drone's) and an error of the gripper's pose by up to 2 cm and 1.5° along and about
each axis. The rest is the machine's own: arm, jaws, encoders, monitors; it is welded to the ground.

An attempt is placed if no monitor reported trouble on the way, the stone was lifted, and it stands
after its release no lower than 0.2 m and no farther than 0.6 m from where it was set down. After a
failed one the stone is viewed and planned anew, up to three times; grasps unlike those before come
first, as in missions. All rankings see the same views, and plan as in missions, whatever the world
is. The bounds are for the learned ranking. Fifteen seconds to a minute a site.
"""

import sys
from collections.abc import Sequence

from bounds import verdict
from grasp_sites import read

USAGE = """
python tests/benchmarks/grasp_attempts.py FOLDER run generated learned 1:15
python tests/benchmarks/grasp_attempts.py FOLDER run SCANS learned 1:5 --scale 10 --scenario wet
python tests/benchmarks/grasp_attempts.py FOLDER table
"""


def main(words: Sequence[str] | None = None) -> int:
    given, path = read(__doc__, USAGE, "attempts.jsonl", words)

    from trials import grasp_attempts, grasp_rows

    if given.verb == "run":
        world = grasp_rows.World(given.stones, given.scale, given.scenario)
        rows = grasp_attempts.sites_run(path, world, given.ranking, given.sites)
    else:
        rows = grasp_rows.read(path)
    print(grasp_rows.table(rows))
    return verdict(grasp_rows.figures(rows))


if __name__ == "__main__":
    sys.exit(main())
