"""Draw what became of one stone, from above and from the side, by the object database of a run.

    executive run pick_and_place --seed 9931 --set robot.scenario=wet --run-dir runs/wet
    python docs/hold_pictures.py runs/wet 2 80 120 docs/images/fall_found.png
    executive run pick_and_place --seed 26120501 --run-dir runs/slip
    python docs/hold_pictures.py runs/slip 4 194 250 docs/images/slip_caught.png
    executive run pick_and_place --seed 26132060 --stones FLAT_SCANS \\
        --set robot.site.stones.scale=10 --run-dir runs/flat
    python docs/hold_pictures.py runs/flat 4 121 172 docs/images/placement_corrected.png

Each outline is the stone's known surface at the pose that the machine took it to have after an
event: expected where nothing but the gripper's motion tells, measured where it was seen.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from executive_plugins.objects.settings import SqliteObjectsSettings
from executive_plugins.objects.sqlite import SqliteObjects

from executive.arrays import Float
from executive.geometry.polygon import outline_of
from executive.geometry.pose import inverse, transform
from executive.messages.stone_event import StoneEvent

_KINDS = ("found", "grasp", "release", "realign", "seen")


def main(words: Sequence[str]) -> int:
    if len(words) != 5:
        print("usage: python docs/hold_pictures.py RUN_DIR STONE FROM_S TO_S PNG", file=sys.stderr)
        return 2
    events, points = track(Path(words[0]), int(words[1]), float(words[2]), float(words[3]))
    draw(Path(words[4]), events, points)
    print(words[4])
    return 0


def track(run: Path, stone: int, from_s: float, to_s: float) -> tuple[list[StoneEvent], Float]:
    """Return the events of a stone within some time, and its surface in its own frame, (N, 3)."""
    objects = SqliteObjects(SqliteObjectsSettings())
    objects.open(str(run / "objects.sqlite"), read_only=True)
    known = objects.stone(stone)
    events = [
        one
        for one in objects.history(stone)
        if from_s <= one.stamp_s <= to_s and one.kind in _KINDS
    ]
    objects.close()
    return events, transform(inverse(known.T_map_object), known.points_map)


def draw(path: Path, events: Sequence[StoneEvent], points: Float) -> None:
    mpl.use("Agg")
    from matplotlib import pyplot as plt

    figure, (above, beside) = plt.subplots(1, 2, figsize=(12, 5.6), dpi=110, layout="constrained")
    along = _along(events, points)
    colours = plt.get_cmap("viridis")(np.linspace(0.0, 0.85, len(events)))
    for number, (event, colour) in enumerate(zip(events, colours, strict=True), start=1):
        surface = transform(event.T_map_object, points)
        style = "--" if event.kind in ("grasp", "release") else "-"
        label = f"{number}: {event.stamp_s:.0f} s, {_words(event)}"
        profile = np.column_stack([surface[:, :2] @ along, surface[:, 2]])
        for axes, flat in ((above, surface[:, :2]), (beside, profile)):
            ring = outline_of(flat)
            axes.plot(*np.vstack([ring, ring[:1]]).T, style, color=colour, label=label, lw=1.8)
            axes.annotate(str(number), ring[number % len(ring)], color=colour, weight="bold")
    above.set(title="from above", xlabel="x [m]", ylabel="y [m]", aspect="equal")
    beside.set(title="from the side", xlabel="along the motion [m]", ylabel="z [m]", aspect="equal")
    handles, labels = above.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncol=2, frameon=False, fontsize=9)
    figure.savefig(path)
    plt.close(figure)


def _along(events: Sequence[StoneEvent], points: Float) -> Float:
    """Return the horizontal direction of the last motion of the stone's points, shape (2,)."""
    first, last = (transform(one.T_map_object, points)[:, :2] for one in events[-2:])
    return np.asarray(np.linalg.svd(last - first, full_matrices=False)[2][0])


def _words(event: StoneEvent) -> str:
    kind = {"realign": "seen", "release": "let go"}.get(event.kind, event.kind)
    note = event.note.split(", rmse")[0]
    return f"{kind}: {note}" if note else kind


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
