"""A held stone, and the motions that bring it over a slot."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from executive.arrays import Float
from executive.geometry.convex import volume_and_centroid
from executive.geometry.pose import pose
from executive.geometry.rotation import about_axis

_UP = np.array([0.0, 0.0, 1.0])
_RING_M = 0.5  # width of the ring of ground around the stone that gives the height of its foot
# Largest height of a model's lowest point above the foot of the stone: survey and segmentation
# may miss the foot.
_SUNK_M = 0.3


@dataclass(frozen=True, slots=True, eq=False)
class HeldStone:
    """The stone to set down, in the map, at the pose of its grasp.

    Attributes:
        points: Model of the stone [m], shape (N, 3).
        centre: Centre of volume of its hull [m], shape (3,).
        bottom_m: Height of its lowest part in the map, or of the ground that it rested on where
            that was seen [m].
        radius_m: Radius, from above, of the circle around the centre that contains it [m].
    """

    points: Float
    centre: Float
    bottom_m: float
    radius_m: float

    @classmethod
    def of(cls, points: Float, around: Float) -> "HeldStone":
        """Describe a stone by its model (N, 3) and the cloud around (M, 3), in one frame with z up.

        Raises:
            DataError: If the model spans no volume.
        """
        _, centre = volume_and_centroid(points)
        radius_m = float(np.linalg.norm(points[:, :2] - centre[:2], axis=1).max())
        lowest = float(points[:, 2].min())
        distance = np.linalg.norm(around[:, :2] - centre[:2], axis=1)
        ring = around[
            (distance < radius_m + _RING_M) & (np.abs(around[:, 2] - lowest) < _SUNK_M), 2
        ]
        bottom = min(lowest, float(np.median(ring))) if len(ring) else lowest
        return cls(points, centre, bottom, radius_m)

    def centred(self, centre_xy: Float) -> "HeldStone":
        """Return the stone with another middle (2,), such as that of its box from above."""
        radius_m = float(np.linalg.norm(self.points[:, :2] - centre_xy, axis=1).max())
        centre = np.array([*centre_xy, self.centre[2]])
        return HeldStone(self.points, centre, self.bottom_m, radius_m)


def aligned_poses(
    held: HeldStone, position_map: Float, bottom_m: float, turn_rad: float, turns: int
) -> Iterator[Float]:
    """Yield motions T_map_map that put the middle of a stone over a place, turned as wanted.

    The first two have the turn [rad], and the same turn by half a circle more, which gives the same
    box. The others deviate from it by growing steps of a circle's share.
    """
    target = np.array([*position_map[:2], bottom_m + held.centre[2] - held.bottom_m])
    steps = np.arange(turns) * np.pi / turns
    off = (steps + np.pi / 2) % np.pi - np.pi / 2
    for extra in off[np.lexsort((off, np.abs(off).round(9)))]:
        for half in (0.0, np.pi):
            R = about_axis(_UP, turn_rad + float(extra) + half)
            yield pose(R, target - R @ held.centre)


def release_poses(
    held: HeldStone, position_map: Float, bottom_m: float, T_map_base: Float, turns: int
) -> Iterator[Float]:
    """Yield motions T_map_map that put the centre of a stone over a place.

    The bottom of the stone comes to a given height. The motions turn it about the vertical only, so
    it keeps its attitude to gravity. The first motion turns it with the cabin; the others add
    growing turns of the wrist to either side.
    """
    azimuth = [np.arctan2(*(p - T_map_base[:3, 3])[1::-1]) for p in (held.centre, position_map)]
    steps = np.arange(turns) * 2 * np.pi / turns
    wrist = (steps + np.pi) % (2 * np.pi) - np.pi
    for turn in wrist[np.lexsort((wrist, np.abs(wrist).round(9)))]:
        R = about_axis(_UP, azimuth[1] - azimuth[0] + float(turn))
        target = np.array(
            [position_map[0], position_map[1], bottom_m + held.centre[2] - held.bottom_m]
        )
        yield pose(R, target - R @ held.centre)
