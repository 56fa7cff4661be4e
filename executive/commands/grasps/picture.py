"""The picture of a grasp: the gripper closed on its stone, from the side, along the jaws, and in
space. Where the jaws open is drawn faintly.
"""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from scipy.spatial import ConvexHull

from executive.arrays import Float
from executive.geometry.convex import depth_inside, half_spaces
from executive.geometry.pose import inverse, transform
from executive.machine.gripper import Gripper
from executive.messages.grasp import Grasp

_STONE, _AROUND, _PALM, _JAWS = "#b5523b", "#8f8f8f", "#5b6770", "#e0a100"
_WINDOW_M = 1.15  # of the widest opening: what is drawn to each side of the palm
_MOST_POINTS = 6000
_STEP_RAD = 0.02
_OPEN, _CLOSED = 0.12, 0.5  # opacities


def draw_grasp(
    path: Path, grasp: Grasp, stone: Float, cloud: Float, gripper: Gripper, title: str
) -> None:
    """Draw one grasp and save it as PNG.

    Args:
        path: The file.
        grasp: The grasp.
        stone: Points of the stone in the map [m], shape (N, 3).
        cloud: All points about it, shape (M, 3).
        gripper: The gripper.
        title: Stands above.
    """
    T = inverse(grasp.T_map_gripper)
    half_m = _WINDOW_M * gripper.max_opening_m / 2
    shown = [_thin(_within(transform(T, points), 1.6 * half_m)) for points in (cloud, stone)]
    figure = Figure(figsize=(14, 5))
    figure.suptitle(title, fontsize=11)
    figure.subplots_adjust(left=0.05, right=0.97, bottom=0.11, top=0.86, wspace=0.18)
    side, along, space = (
        figure.add_subplot(1, 3, i + 1, **kind)
        for i, kind in enumerate(({}, {}, {"projection": "3d"}))
    )
    open_rad = gripper.jaw_rad(min(grasp.opening_m, gripper.max_opening_m))
    parts = gripper.hulls(touching_rad(gripper, transform(T, stone), open_rad))
    _draw_view(side, shown, parts, (1, 0), (half_m, gripper.jaw_width_m / 2))
    _draw_parts(side, gripper.hulls(open_rad), (1, 0), _OPEN)
    side.set(
        xlabel="opening [m]", ylabel="along the approach [m]", title="a slice as wide as the jaws"
    )
    _draw_view(along, shown, parts, (2, 0), (half_m, gripper.max_opening_m / 2))
    along.set(
        xlabel="width [m]", ylabel="along the approach [m]", title="from the side: between the tips"
    )
    _draw_space(
        space,
        [transform(grasp.T_map_gripper, points) for points in shown],
        parts,
        grasp.T_map_gripper,
    )
    figure.savefig(path, dpi=110)


def touching_rad(gripper: Gripper, stone_gripper: Float, open_rad: float) -> float:
    """Return the angle at which jaws that close from an angle touch a stone; 0 if they do not.

    Args:
        gripper: The gripper.
        stone_gripper: Points of the stone in the gripper's frame [m], shape (N, 3).
        open_rad: The angle from which they close.
    """
    angle_rad = open_rad
    while angle_rad > 0:
        parts = gripper.hulls(angle_rad)
        for hull in (hull for name in gripper.links for hull in parts[name]):
            if (depth_inside(half_spaces(hull), stone_gripper) > 0).any():
                return angle_rad
        angle_rad -= _STEP_RAD
    return 0.0


def _draw_view(
    axes: Any, shown: list[Float], parts: Any, ij: tuple[int, int], reach_m: tuple[float, float]
) -> None:
    """Draw points and the outline of each convex part in one plane of the gripper's frame, the palm
    on top.
    """
    (i, j), (half_m, slice_m) = ij, reach_m
    for points, colour in zip(shown, (_AROUND, _STONE), strict=True):
        near = points[np.abs(points[:, 3 - i - j]) <= slice_m]
        axes.plot(near[:, i], near[:, j], ".", markersize=2, color=colour)
    _draw_parts(axes, parts, ij, _CLOSED)
    axes.set(aspect="equal", xlim=(-half_m, half_m), ylim=(1.5 * half_m, -0.6 * half_m))


def _draw_parts(axes: Any, parts: Any, ij: tuple[int, int], opacity: float) -> None:
    for name, hulls in parts.items():
        for hull in hulls:
            flat = hull[:, ij]
            outline = flat[ConvexHull(flat).vertices]
            axes.fill(*outline.T, color=_PALM if name == "palm" else _JAWS, alpha=opacity)


def _draw_space(axes: Any, shown: list[Float], parts: Any, T_map_gripper: Float) -> None:
    for points, colour in zip(shown, (_AROUND, _STONE), strict=True):
        axes.plot(*points.T, ".", markersize=1.2, color=colour, alpha=0.6)
    for name, hulls in parts.items():
        for hull in hulls:
            corners = transform(T_map_gripper, hull)
            triangles = ConvexHull(corners).simplices
            axes.plot_trisurf(
                *corners.T, triangles=triangles, color=_PALM if name == "palm" else _JAWS, alpha=0.6
            )
    axes.set(aspect="equal", title="in the cloud", xticklabels=(), yticklabels=(), zticklabels=())
    axes.view_init(
        elev=22, azim=np.degrees(np.arctan2(T_map_gripper[1, 1], T_map_gripper[0, 1])) - 60
    )


def _within(points: Float, half_m: float) -> Float:
    """Return the points in the box about the gripper, from behind the palm to below the tips."""
    return np.asarray(points[(np.abs(points - (0.5 * half_m, 0.0, 0.0)) < half_m).all(axis=1)])


def _thin(points: Float) -> Float:
    return points[:: 1 + len(points) // _MOST_POINTS]
