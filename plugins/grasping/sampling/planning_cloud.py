"""The planning cloud: a stone, its neighbours and the ground (Mascaro 2020, Sec. 5.2).

All points have one density. The cloud is built in a frame of the stone: origin at the mean of its
points, z up, x along its longer side. The same scene, turned or shifted in the map, therefore gives
the same numbers and the same grasp.
"""

from dataclasses import dataclass

import numpy as np
from executive_plugins.grasping.sampling.ground import Ground, fill_ground, fit_ground
from scipy.spatial import cKDTree

from executive.arrays import Bool, Float
from executive.geometry.convex import convex_corners, volume_and_centroid
from executive.geometry.normals import outward_normals
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import about_axis
from executive.geometry.voxels import voxel_means

_FOOT_M = 0.15  # largest height of a stone's foot that segmentation classified as ground
_REACH_M = 0.10  # largest distance of such a foot from the known points of the stone
_SLAB_M, _YAWS = 0.1, 90  # half height of the slab, and number of directions, for the width
_LEVEL_M = 0.03  # points lower than this above the ground belong to the ground
_SOIL_M = 0.06  # the same of points that are soil: twice that, since rough ground is no plane


@dataclass(frozen=True, slots=True, eq=False)
class PlanningCloud:
    """The points that grasps are planned on, in the frame `plan` of the stone.

    Attributes:
        T_map_plan: Pose of that frame, shape (4, 4).
        points: Points of the stone, then those of neighbours and ground [m], shape (N, 3).
        is_target: Mask of the stone's points, shape (N,).
        normals: Outward normals of the stone's points, shape (T, 3).
        centre: Centre of volume of the stone's convex hull [m], shape (3,).
        volume_m3: Volume of that hull.
        ground: The ground.
        scale: Factor on the lengths of this file, see `SamplingSettings`.
    """

    T_map_plan: Float
    points: Float
    is_target: Bool
    normals: Float
    centre: Float
    volume_m3: float
    ground: Ground
    scale: float

    def body(self, foot: float = 1.0) -> Float:
        """Return corners of the stone's hull, extended down to the ground [m], shape (V, 3).

        The underside is not seen: points near the ground are projected onto it.

        Args:
            foot: Size of the foot on the ground over that of the outline above it: 1 goes straight
                down, less is drawn in.
        """
        height = self.stone[:, 2] - self.ground.height(self.stone[:, :2])
        is_low = height < self.scale * _FOOT_M
        if not is_low.any():
            return convex_corners(self.stone)
        below = (self.stone - height[:, None] * (0.0, 0.0, 1.0))[is_low]
        middle = below[:, :2].mean(axis=0)
        below[:, :2] = middle + foot * (below[:, :2] - middle)
        return convex_corners(np.concatenate([self.stone, below]))

    @property
    def least_width_m(self) -> float:
        """Least horizontal width of the seen points near the height of the centre [m].

        Parts of the stone that were not seen are missing in it.
        """
        slab = self.stone[np.abs(self.stone[:, 2] - self.centre[2]) < self.scale * _SLAB_M, :2]
        yaw = np.linspace(0.0, np.pi, _YAWS, endpoint=False)
        along = slab @ np.stack([np.cos(yaw), np.sin(yaw)])
        return float(np.ptp(along, axis=0).min()) if len(slab) else 0.0

    @property
    def stone(self) -> Float:
        """The stone's points, shape (T, 3)."""
        return self.points[self.is_target]


def build_planning_cloud(
    stone_map: Float,
    cloud_map: Float,
    margin_m: float,
    spacing_m: float,
    rng: np.random.Generator,
    scale: float = 1.0,
    into_soil_m: float = 0.0,
) -> PlanningCloud:
    """Crop the map around a stone, merge the stone's model, thin, and complete the ground.

    The tips of the jaws go into soil: its points lie as much lower, so that what is planned on the
    cloud may. Neighbours stay where they are.

    Args:
        stone_map: Best known surface of the stone, merged from lidar, drone and earlier views [m],
            shape (T, 3).
        cloud_map: The map, the stone included [m], shape (N, 3).
        margin_m: Distance around the stone that is kept: the reach of the open gripper to each
            side.
        spacing_m: Point spacing of the result.
        rng: Random generator of the ground's RANSAC.
        scale: Factor on the lengths of this file, see `SamplingSettings`.
        into_soil_m: How far the tips may go below the ground.

    Raises:
        DataError: If the stone's points span no volume.
    """
    T_map_plan = _stone_frame(stone_map)
    T_plan_map = inverse(T_map_plan)
    stone = voxel_means(transform(T_plan_map, stone_map), spacing_m)
    low, high = stone.min(axis=0) - margin_m, stone.max(axis=0) + margin_m
    cloud = transform(T_plan_map, cloud_map)
    cloud = cloud[((cloud > low) & (cloud < high)).all(axis=1)]
    distance, _ = cKDTree(stone).query(cloud)
    ground = fit_ground(
        voxel_means(cloud[distance > 1.5 * spacing_m], spacing_m), stone, rng, scale
    )
    is_foot = _is_foot(cloud, distance, ground, scale)
    stone = voxel_means(np.concatenate([stone, cloud[is_foot]]), spacing_m)
    around = cloud[(distance > 1.5 * spacing_m) & ~is_foot]
    others = voxel_means(
        np.concatenate([around, fill_ground(ground, stone, low[:2], high[:2], spacing_m)]),
        spacing_m,
    )
    is_soil = np.abs(others[:, 2] - ground.height(others[:, :2])) < scale * _SOIL_M
    others[is_soil, 2] -= into_soil_m
    return _planning_cloud(T_map_plan, stone, others, ground, scale)


def _planning_cloud(
    T_map_plan: Float, stone: Float, others: Float, ground: Ground, scale: float
) -> PlanningCloud:
    """Assemble the parts and compute the normals, the centre and the volume."""
    volume_m3, centre = volume_and_centroid(stone)
    return PlanningCloud(
        T_map_plan=T_map_plan,
        points=np.concatenate([stone, others]),
        is_target=np.arange(len(stone) + len(others)) < len(stone),
        normals=outward_normals(stone, centre),
        centre=centre,
        volume_m3=volume_m3,
        ground=ground,
        scale=scale,
    )


def _stone_frame(stone_map: Float) -> Float:
    """Return T_map_plan, with its origin at the mean of the points.

    Its x axis is the horizontal direction of largest spread, towards the longer tail.
    """
    middle = stone_map.mean(axis=0)
    flat = (stone_map - middle)[:, :2]
    x = np.linalg.eigh(flat.T @ flat)[1][:, 1]
    x = x if ((flat @ x) ** 3).sum() >= 0 else -x
    return pose(about_axis(np.array([0.0, 0.0, 1.0]), float(np.arctan2(x[1], x[0]))), middle)


def _is_foot(cloud: Float, distance: Float, ground: Ground, scale: float) -> Bool:
    """Return which points belong to the foot of the stone, shape (N,).

    They are low, above the ground and close to the stone; segmentation classified them as ground.
    """
    is_foot = distance < scale * _REACH_M
    height = cloud[is_foot, 2] - ground.height(cloud[is_foot, :2])
    is_foot[is_foot] = (height > scale * _LEVEL_M) & (height < scale * _FOOT_M)
    return is_foot
