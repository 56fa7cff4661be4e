"""The surroundings of a slot: clearance of the stone and of the opening jaws."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from executive.arrays import Bool, Float
from executive.geometry.convex import depth_inside, half_spaces
from executive.geometry.polygon import Box, contains, rectangle
from executive.geometry.pose import inverse, transform
from executive.geometry.voxels import first_in_cells
from executive.machine.gripper import Gripper
from executive.machine.jaw_clearance import ROOM_M, angle_closed_on, release_angles
from executive.messages.placement import Slot

_IN_GROUND_M = 0.02  # a ground point deeper than this in the gripper is a collision
_LEVEL_M = 0.15  # points higher than this above the ground belong to neighbours
# Least distance of a neighbour from the stone and the jaws; its far side may not have been seen.
_APART_M = 0.10
_GROUND_BAND_M = 0.35  # ground under the stone is at most this far from the slot's height
_HIGHEST = 0.95  # quantile of the ground heights on which the stone comes to lie
_LOWEST = 0.1  # the same of those that are lowest: ground, and not a hole in it
_INNER = 0.8  # share of the stone's width under which ground carries it
_SPACING_M = 0.05  # point spacing that suffices for the check


@dataclass(frozen=True, slots=True, eq=False)
class SlotFoot:
    """The ground that a stone on a slot takes up.

    Attributes:
        position_map: The slot's place [m], shape (3,).
        radius_m: Distance of the stone's farthest point from the slot, from above [m].
        corners_map: Corners of the stone's box on the slot; None where it may turn freely.
        apart_m: Least distance of the stone and the jaws from neighbours [m].
        lowered_m: How far the jaws go down with the stone from the pose at which it is checked to
            that in which it is to rest [m]; None where only the ground says how it will rest.
    """

    position_map: Float
    radius_m: float
    corners_map: Float | None = None
    apart_m: float = _APART_M
    lowered_m: float | None = None

    @classmethod
    def of(cls, slot: Slot, radius_m: float, box: Box | None, drop_m: float = 0.0) -> "SlotFoot":
        """Return the foot of a stone on a slot; neighbours may come as near as half of its gap.

        Where the slot has the pose of a stone, that is checked `drop_m` above it.
        """
        apart_m = _APART_M if slot.gap_m is None else min(_APART_M, slot.gap_m / 2)
        if slot.T_map_object is not None:
            return cls(slot.position_map, radius_m, None, apart_m, drop_m)
        if box is None or slot.heading_rad is None:
            return cls(slot.position_map, radius_m, None, apart_m)
        centre = slot.position_map[:2]
        sides = _INNER * box.length_m, _INNER * box.width_m
        return cls(
            slot.position_map, radius_m, rectangle(centre, *sides, slot.heading_rad), apart_m
        )

    def is_under(self, points: Float) -> Bool:
        """Return which points lie below the inner part of the stone, shape (N,)."""
        if self.corners_map is not None:
            return contains(self.corners_map, points[:, :2])
        away = np.linalg.norm(points[:, :2] - self.position_map[:2], axis=1)
        return np.asarray(away < _INNER * self.radius_m)


class SlotSurroundings:
    """The cloud near a slot, split into ground and neighbours."""

    def __init__(self, gripper: Gripper, cloud: Float, foot: SlotFoot) -> None:
        self._apart_m, self._lowered_m = foot.apart_m, foot.lowered_m
        self._gripper = gripper
        self._palm = [half_spaces(shape.vertices) for shape in gripper.palm_shapes]
        self._jaws = {
            name: [half_spaces(shape.vertices) for shape in link.shapes]
            for name, link in gripper.links.items()
        }
        widest = [hull for parts in gripper.hulls(gripper.open_rad).values() for hull in parts]
        self._reach_m = max(float(np.linalg.norm(hull, axis=1).max()) for hull in widest) + _APART_M
        distance = np.linalg.norm(cloud[:, :2] - foot.position_map[:2], axis=1)
        near = cloud[distance < foot.radius_m + self._reach_m]
        near = near[first_in_cells(near, _SPACING_M)]
        level = float(foot.position_map[2])
        under = cloud[foot.is_under(cloud) & (np.abs(cloud[:, 2] - level) < _GROUND_BAND_M), 2]
        is_posed = foot.lowered_m is not None  # what is under the stone may be its neighbours
        is_by_ground = len(under) > 0 and not is_posed
        self.ground_m = float(np.quantile(under, _HIGHEST)) if is_by_ground else level
        is_high = near[:, 2] > self.ground_m + _LEVEL_M
        self._ground, self._neighbours = near[~is_high], near[is_high]
        self._tree = cKDTree(self._neighbours) if is_high.any() else None
        is_on_soil = not is_posed or _is_on_soil(near, level)
        self._soil = self._ground - (0.0, 0.0, gripper.digs_m if is_on_soil else 0.0)
        self._bed = self._ground[:0] if is_on_soil else self._ground
        if is_posed and self._tree is not None:  # the foot of a neighbour is no soil
            high = cKDTree(self._neighbours[:, :2])
            is_foot = high.query(self._ground[:, :2])[0] < _LEVEL_M
            self._soil[is_foot] = self._ground[is_foot]

    def is_free(self, T_map_gripper: Float, stone_map: Float) -> bool:
        """Return whether stone and opening jaws clear the neighbours, and the jaws the ground.

        The jaws may be in the ground as far as they dig. The stones below a place on other stones
        are no ground: where the stone is to rest, the jaws that let it go are 5 cm from them.
        The jaws open as far as they do to let this stone go (`ReleaseStone`), not as they can.
        Beside stones on which it is to rest they open by half of that where there is no more room,
        and are where it rests by then.
        """
        if self._tree is not None and self._tree.query(stone_map)[0].min() < self._apart_m:
            return False
        T_gripper_map = inverse(T_map_gripper)
        stone = transform(T_gripper_map, stone_map)
        angles = release_angles(self._gripper, stone, T_map_gripper[2, :3])
        if self._lowered_m is None:
            apart_m, neighbours, opened = self._apart_m, self._neighbours, angles
        else:
            apart_m, opened = max(self._apart_m, ROOM_M), angles[:2]
            lowered = 0.0, 0.0, self._lowered_m
            neighbours, bed = self._neighbours + lowered, self._bed + lowered
            if self._depth_m(transform(T_gripper_map, bed), opened) > -ROOM_M:
                return False
            # The jaws come down closed on the stone, with their tips below its widest part.
            held = np.array([min(angle_closed_on(self._gripper, stone), angles[0])])
            others = transform(T_gripper_map, np.vstack([neighbours, bed]))
            if self._depth_m(others, held) > -ROOM_M:
                return False
        if self._depth_m(transform(T_gripper_map, neighbours), opened) > -apart_m:
            return False
        return self._depth_m(transform(T_gripper_map, self._soil), angles) < _IN_GROUND_M

    def _depth_m(self, points_gripper: Float, angles: Float) -> float:
        """Return the largest depth of a point in the gripper at any of the jaws' angles [m].

        It is negative if all points are outside.
        """
        near = points_gripper[np.linalg.norm(points_gripper, axis=1) < self._reach_m]
        deepest = max(_deepest(faces, near) for faces in self._palm)
        for name, parts in self._jaws.items():
            for angle in angles:
                of_jaw = transform(inverse(self._gripper.T_gripper_jaw(name, float(angle))), near)
                deepest = max(deepest, *(_deepest(faces, of_jaw) for faces in parts))
        return deepest


def _is_on_soil(near: Float, level_m: float) -> bool:
    """Return whether a stone whose lowest point is at a level rests on the ground itself.

    Beside one that rests on others, part of what is near lies lower than the foot of a neighbour.
    """
    return len(near) > 0 and level_m < float(np.quantile(near[:, 2], _LOWEST)) + _LEVEL_M


def _deepest(faces: Float, points: Float) -> float:
    return float(depth_inside(faces, points).max(initial=-np.inf))
