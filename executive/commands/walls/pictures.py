"""Pictures of a structure as it grows: the face from the side, and the plan from above."""

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from executive.arrays import Float
from executive.commands.walls.construction import PlacedStone
from executive.messages.building import AsBuilt

_OLD, _NEW, _EDGE = np.array([0.62, 0.62, 0.60]), np.array([0.86, 0.58, 0.24]), "#6b3f0d"
_AROUND_M = 0.2  # around the foot of the envelope, so that its outline is closed
_LIGHT = np.array([-0.35, -0.65, 0.67])  # towards the light; no longer than 1


def draw_courses(folder: Path, placed: Sequence[PlacedStone], courses: int) -> list[Path]:
    """Write `course_1.png` …: the stones divided evenly by their order, the new ones coloured."""
    ends = np.unique(np.linspace(0, len(placed), courses + 1).round().astype(int))
    files = []
    for number, (first, last) in enumerate(pairwise(ends), 1):
        path = folder / f"course_{number}.png"
        draw(path, placed[last - 1].built, int(first))
        files.append(path)
    return files


def draw(path: Path, built: AsBuilt, first_new: int) -> None:
    """Draw a structure and save it as PNG; stones from number `first_new` on are coloured."""
    figure = Figure(figsize=(11, 6.5), layout="constrained")
    side, above = figure.subplots(2, 1)
    heading = built.structure.heading_rad(built.structure.length_m / 2)
    along = np.array([np.cos(heading), np.sin(heading), 0.0])
    across, up = np.array([-along[1], along[0], 0.0]), np.array([0.0, 0.0, 1.0])
    _draw_stones(side, built, first_new, np.stack([along, up, across]))
    _draw_stones(above, built, first_new, np.stack([along, across, up * -1.0]))
    _draw_envelope(side, above, built, along[:2], across[:2])
    side.set_title(
        f"{built.structure.name}: {len(built.standing)} stones, from the side", loc="left"
    )
    above.set_title("from above", loc="left")
    for axes in (side, above):
        axes.set_aspect("equal")
        axes.set_xlabel("along [m]")
        axes.autoscale_view()
    side.set_ylabel("height [m]")
    above.set_ylabel("across [m]")
    figure.savefig(path, dpi=80)


def _draw_stones(axes: Axes, built: AsBuilt, first_new: int, view: Float) -> None:
    """Draw all triangles, the farthest first; rows of `view` are right, up, and away."""
    shapes, colours, depths = [], [], []
    for number, one in enumerate(built.standing):
        corners = one.vertices_map()[one.stone.triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True) + 1e-12
        is_seen = normals @ view[2] < 0
        shade = 0.45 + 0.55 * np.maximum(normals[is_seen] @ _LIGHT, 0.0)
        base = _NEW if number >= first_new else _OLD
        shapes.append(corners[is_seen] @ view[:2].T)
        colours.append(shade[:, None] * base)
        depths.append(corners[is_seen].mean(axis=1) @ view[2])
    if shapes:
        order = np.argsort(-np.concatenate(depths))
        faces = np.concatenate(colours)[order]
        axes.add_collection(
            PolyCollection(list(np.concatenate(shapes)[order]), facecolors=faces, edgecolors="none")
        )


def _draw_envelope(side: Axes, above: Axes, built: AsBuilt, along: Float, across: Float) -> None:
    structure = built.structure
    x = structure.line @ along
    ground = built.ground.at(structure.line)
    half = structure.thickness_m / 2 if len(structure.line) == 1 else 0.0
    ends = np.array([x.min() - half, x.max() + half])
    foot = np.interp(ends, np.sort(x), ground[np.argsort(x)])
    side.plot(ends, foot, "-", color=_EDGE, lw=1.5)
    side.plot(ends, foot + structure.height_m, "--", color=_EDGE, lw=1)
    low, high = structure.bounds()
    low, high = low - _AROUND_M, high + _AROUND_M
    nodes = np.stack(np.meshgrid(*(np.linspace(low[k], high[k], 160) for k in (0, 1))), axis=-1)
    flat = nodes.reshape(-1, 2)
    depth = structure.depth_m(flat, np.zeros(len(flat))).reshape(nodes.shape[:2])
    above.contour(nodes @ along, nodes @ across, depth, levels=[0.0], colors=_EDGE, linewidths=1)
