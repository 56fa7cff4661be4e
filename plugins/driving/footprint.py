"""The space that a machine needs while it drives: a box for each of its links."""

from dataclasses import dataclass

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import transform
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine


@dataclass(frozen=True, slots=True, eq=False)
class Footprint:
    """Boxes about the links in the posture for driving, their sides along the base frame's axes.

    Attributes:
        low: Corner of each box with the least coordinates [m], shape (b, 3).
        high: Opposite corner [m], shape (b, 3).
        supports: Places (x, y) of the base frame whose ground bears the machine [m], shape (s, 2).
    """

    low: Float
    high: Float
    supports: Float

    @property
    def radius_m(self) -> float:
        """Largest distance of a corner from the base frame's z axis [m]."""
        corners = np.maximum(np.abs(self.low), np.abs(self.high))
        return float(np.hypot(corners[:, 0], corners[:, 1]).max())

    def hits(self, points_base: Float) -> bool:
        """Return whether any point (N, 3) is in a box."""
        inside = (points_base[:, None] >= self.low) & (points_base[:, None] <= self.high)
        return bool(inside.all(axis=2).any())


def footprint(machine: Machine, clearance_m: float) -> Footprint:
    """Return the boxes of a machine that drives, wider by a clearance.

    Raises:
        ValueError: If it does not drive.
    """
    if machine.driving is None:
        raise ValueError(f"{machine.name} does not drive")
    frames = Kinematics(machine).frames(machine.posture(machine.driving.posture))
    low, high = [], []
    for name, link in machine.links.items():
        for shape in link.shapes:
            corners = transform(frames[name], shape.vertices) if name in frames else None
            if corners is not None:
                low.append(corners.min(axis=0))
                high.append(corners.max(axis=0))
    ground_m = -machine.stance.base_height_m
    lowest = np.array(low) - clearance_m
    # The ground itself is no obstacle: what is lower than a step is driven over.
    lowest[:, 2] = np.maximum(lowest[:, 2], ground_m + machine.driving.step_m)
    highest = np.array(high) + clearance_m
    base = machine.links[machine.base_link]
    extent = np.vstack([shape.vertices for shape in base.shapes])
    return Footprint(lowest, highest, _grid(extent[:, :2].min(axis=0), extent[:, :2].max(axis=0)))


def _grid(low: Float, high: Float) -> Float:
    """Return places half a metre apart over a rectangle, shape (n, 2)."""
    x, y = (
        np.linspace(a, b, max(2, round((b - a) / 0.5) + 1)) for a, b in zip(low, high, strict=True)
    )
    return np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
