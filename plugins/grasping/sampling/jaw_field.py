"""The gripper as two tables: its front as the jaws close, and the cells that each jaw sweeps.

A point at gripper coordinates (a, b, c), with a along the approach, is touched when the gripper has
advanced to the depth a − H(b, c), where H is the front height map of palm and jaws. The minimum
over the points is the depth of the push. Closing uses the same rule, with the map of all places
that the jaws have swept so far.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from executive.arrays import Float
from executive.geometry.convex import half_spaces
from executive.machine.gripper import SIDES, Gripper

NEVER = 255  # progress of a cell that a jaw does not sweep
_FAR_M = 1e3
_TOUCH = 1e-6  # share of a cell: a face on a cell border touches it in spite of rounding


@dataclass(frozen=True, slots=True, eq=False)
class JawField:
    """Tables over cells of the gripper frame; progress k = 0 is open, k = K − 1 is closed.

    Attributes:
        cell_m: Edge of a cell [m].
        origin: Corner of the first cell in the gripper frame [m], shape (3,).
        front: H_k(b, c): front of the palm and of all jaw positions 0 … k, grown by the skin [m];
            −1000 in empty columns; shape (K, B, C), float32.
        sweep: Progress at which the left and the right jaw first touch a cell, or NEVER,
            shape (2, A, B, C), uint8.
        tip_a: Position of the tips along the approach at each progress [m], shape (K,).
        tip_b: Half the distance between the tips at each progress [m], shape (K,).
        jaw_rad: Jaw angle at each progress [rad], shape (K,).
    """

    cell_m: float
    origin: Float
    front: NDArray[np.float32]
    sweep: NDArray[np.uint8]
    tip_a: Float
    tip_b: Float
    jaw_rad: Float


def build_jaw_field(gripper: Gripper, cell_m: float, skin_m: float, steps: int = 33) -> JawField:
    """Tabulate a gripper at `steps` jaw angles from open to closed.

    The skin [m] enlarges only the front map.
    """
    jaw_rad = np.linspace(gripper.open_rad, 0.0, steps)
    shapes = [gripper.hulls(float(angle)) for angle in jaw_rad]
    corners = np.concatenate(
        [hull for parts in shapes for hulls in parts.values() for hull in hulls]
    )
    low, high = corners.min(axis=0) - skin_m - cell_m, corners.max(axis=0) + skin_m + cell_m
    size = np.ceil((high - low) / cell_m).astype(int)
    grid = _Grid(low, size, cell_m)

    front = np.full((steps, size[1], size[2]), -_FAR_M, dtype=np.float32)
    sweep = np.full((2, *size), NEVER, dtype=np.uint8)
    for k, parts in enumerate(shapes):
        # The palm stays where it is: the front of the first progress has it for all.
        faces = {
            name: [half_spaces(hull) for hull in hulls]
            for name, hulls in parts.items()
            if k == 0 or name in SIDES
        }
        for side, name in enumerate(SIDES):
            grid.sweep(faces[name], k, sweep[side])
        every = [one for of_part in faces.values() for one in of_part]
        front[k] = np.maximum(front[max(k - 1, 0)], grid.front(every, skin_m))
    tips = np.array([gripper.tips(float(angle)) for angle in jaw_rad])
    return JawField(
        cell_m=cell_m,
        origin=low,
        front=front,
        sweep=sweep,
        tip_a=tips[:, :, 0].mean(axis=1),
        tip_b=np.abs(tips[:, 0, 1] - tips[:, 1, 1]) / 2,
        jaw_rad=jaw_rad,
    )


class _Grid:
    """Columns (b, c) of the gripper frame, and the intervals that polyhedra fill in them."""

    def __init__(self, low: Float, size: NDArray[Any], cell_m: float) -> None:
        self._half_m = cell_m * (0.5 + _TOUCH)
        self._a = low[0] + cell_m * (np.arange(size[0]) + 0.5)
        b = low[1] + cell_m * (np.arange(size[1]) + 0.5)
        c = low[2] + cell_m * (np.arange(size[2]) + 0.5)
        self._bc = np.stack(np.meshgrid(b, c, indexing="ij"), axis=-1)

    def column(self, faces: Float, skin_m: float) -> tuple[Float, Float]:
        """Return the ends of a convex polyhedron along a within each column's square, (B, C) each.

        Where it does not fill any part of the column, low > high.

        Args:
            faces: Its half-spaces, shape (F, 4).
            skin_m: Distance by which all faces are moved outwards [m].
        """
        n, d = faces[:, :3], faces[:, 3] + skin_m
        d = d + self._half_m * np.abs(n[:, 1:]).sum(axis=1)  # support of the square
        room = d - self._bc @ n[:, 1:].T  # n_a · a ≤ room
        with np.errstate(divide="ignore", invalid="ignore"):
            bound = room / n[:, 0]
        along = np.abs(n[:, 0]) > 1e-9
        high = np.where(along & (n[:, 0] > 0), bound, np.inf).min(axis=-1)
        low = np.where(along & (n[:, 0] < 0), bound, -np.inf).max(axis=-1)
        beside = (np.where(along, 0.0, room) < 0).any(axis=-1)
        return np.where(beside, np.inf, low), high

    def front(self, polyhedra: Iterable[Float], skin_m: float) -> Float:
        """Return the front of some polyhedra in each column, −1000 in empty ones, shape (B, C)."""
        height = np.full(self._bc.shape[:2], -_FAR_M)
        for faces in polyhedra:
            low, high = self.column(faces, skin_m)
            height = np.maximum(height, np.where(low <= high, high, -_FAR_M))
        return height

    def sweep(self, polyhedra: Iterable[Float], progress: int, field: NDArray[np.uint8]) -> None:
        """Record the progress in all cells that one of the polyhedra touches for the first time."""
        for faces in polyhedra:
            low, high = (end[None] for end in self.column(faces, 0.0))
            a, half = self._a[:, None, None], self._half_m
            touched = (a + half >= low) & (a - half <= high)
            np.minimum(field, np.where(touched, progress, NEVER).astype(np.uint8), out=field)
