"""Draw the structure that a run of `build_wall` has built, stone by stone, for `walls.md`.

    executive run build_wall --seed 15112 --run-dir runs/wall
    python docs/wall_pictures.py runs/wall docs/images/wall_mission

Each picture has one stone more, coloured; all of them stand as the machine saw them at the end.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from executive_plugins.objects.settings import SqliteObjectsSettings
from executive_plugins.objects.sqlite import SqliteObjects

from executive.commands.walls.pictures import draw
from executive.events.site import BuildingEnded
from executive.journal import read_journal
from executive.leaf.solid_stones import solid_stones
from executive.messages.building import AsBuilt
from executive.messages.height_grid import HeightGrid


def main(words: Sequence[str]) -> int:
    if len(words) != 2:
        print("usage: python docs/wall_pictures.py RUN_DIR PREFIX", file=sys.stderr)
        return 2
    run, prefix = Path(words[0]), words[1]
    built = as_built(run)
    for count in range(1, len(built.standing) + 1):
        path = Path(f"{prefix}_{count}.png")
        draw(path, built.with_standing(*built.standing[:count]), count - 1)
        print(path)
    return 0


def as_built(run: Path) -> AsBuilt:
    """Return the structure of a run, its stones in the order in which they were placed."""
    ended = [entry.event for entry in read_journal(run / "journal.jsonl")
             if isinstance(entry.event, BuildingEnded)]  # fmt: skip
    if not ended or ended[-1].shape is None:
        raise SystemExit(f"{run}: no structure whose shape is known was ended in this run")
    objects = SqliteObjects(SqliteObjectsSettings())
    objects.open(str(run / "objects.sqlite"), read_only=True)
    try:
        stones = [objects.stone(one) for one in ended[-1].standing]
        stones.sort(key=lambda one: _placed_s(objects, one.id))
        solids = solid_stones(stones, np.zeros((0, 3)), objects)
    finally:
        objects.close()
    structure = ended[-1].shape
    low, high = structure.bounds()
    ground = HeightGrid.plane(low - 2.0, high + 2.0)
    return AsBuilt(structure, ground, tuple(solids.values()))


def _placed_s(objects: SqliteObjects, stone: int) -> float:
    """Return when a stone was released last [s]; one that was never placed came first."""
    released = (one.stamp_s for one in objects.history(stone) if one.kind == "release")
    return max(released, default=0.0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
