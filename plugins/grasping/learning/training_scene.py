"""Training scenes: a stone at rest on level ground, and the partial, noisy cloud of it.

The cloud is that of two lidars on a swinging cabin and, in half of the scenes, also of a drone; or
that of a map after a survey, which shows every stone from all sides and has less noise.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np
from executive_plugins.physics.settling import come_to_rest

from executive.arrays import Bool, Float
from executive.geometry.convex import convex_corners, half_spaces
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import about_axis, exp_so3, from_quaternion
from executive.geometry.voxels import voxel_means

Views = Literal["mixed", "surveyed"]

# A ray caster: origin (3,) and unit directions (K, 3) to ranges (K,), inf for a miss.
Solid = Callable[[Float, Float], Float]

_TILT_RAD = 0.15  # standard deviation of the tilt at the drop
_TIMESTEP_S, _SETTLING_S = 0.004, (0.5, 6.0)  # step, and least and longest time to settle [s]
_RADIUS_M, _HEIGHT_M = (4.0, 8.0), (2.2, 3.2)  # of the lidars: from the stone, and above the ground
_APART_RAD = 0.3  # spread of the directions of the lidars while the cabin swings
_DRONE_RADIUS_M, _DRONE_HEIGHT_M = 5.0, 9.0
_RAYS, _SIGHTS = 6000, 3
_NOISE_M, _GROUND_NOISE_M = (0.01, 0.03), 0.02
# A survey takes a picture from above every few metres. A cell of a map holds the mean of several
# returns. The hull of a rough stone touches the highest points of its surface only, and its lowest
# point has sunk into the soil. The numbers were set by ten stones of two surveyed sites in
# `nominal`, which are in no figure. Of 28 stones of four such sites the points are 1.5 ± 0.4 cm
# inside of the hull (here 1.2 ± 0.1 cm), and the fitted ground is 0.0 ± 1.4 cm above its lowest
# point (here 0.6 ± 1.5 cm).
_PICTURES, _FLIGHT_M, _FLIGHT_HEIGHT_M = 8, 6.0, 8.0
_SURVEY_NOISE_M, _SURVEY_GROUND_NOISE_M, _ROUGH_M = (0.005, 0.012), 0.005, 0.02
_SUNK_M = (0.015, 0.012)  # mean and standard deviation
_WINDOW_M = np.array([2.4, 2.4, 1.4])  # rays aim at points in this box around the stone
_FOOT_M = 0.06  # segmentation classifies lower points as ground
_NEIGHBOUR_M = (1.5, 2.2)  # distance of the centres
_MAP_CELL_M = 0.03


@dataclass(frozen=True, slots=True, eq=False)
class StoneView:
    """The clouds that a planner receives.

    Attributes:
        stone: Known points of the target [m], shape (T, 3).
        cloud: All points, those of the target included [m], shape (N, 3).
    """

    stone: Float
    cloud: Float


def at_rest(hull: Float, rng: np.random.Generator) -> Float | None:
    """Drop a convex stone nearly flat on the ground z = 0 and let it settle.

    The contacts are MuJoCo's defaults, since only the pose at rest matters.

    Args:
        hull: Corners in the frame of the stone [m], shape (V, 3).
        rng: Random generator of its heading and tilt.

    Returns:
        T_world_stone at rest, shape (4, 4); None if the stone does not come to rest.
    """
    R = about_axis(np.array([0.0, 0.0, 1.0]), rng.uniform(0, 2 * np.pi))
    R = R @ exp_so3(np.append(rng.normal(0.0, _TILT_RAD, 2), 0.0)) @ _flat(hull)
    drop = pose(R, np.array([0.0, 0.0, 0.02 - float((hull @ R.T)[:, 2].min())]))
    spec = mujoco.MjSpec()
    spec.option.timestep, spec.option.jacobian = _TIMESTEP_S, mujoco.mjtJacobian.mjJAC_DENSE
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[9, 9, 1])
    spec.add_mesh(name="stone", uservert=transform(drop, hull).ravel())
    stone = spec.worldbody.add_body(name="stone")
    stone.add_freejoint()
    stone.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="stone", density=2600.0)
    model = spec.compile()
    data = mujoco.MjData(model)
    if not come_to_rest(model, data, *_SETTLING_S):
        return None
    return pose(from_quaternion(data.qpos[3:]), data.qpos[:3]) @ drop


def convex_solid(hull: Float) -> Solid:
    """Return a ray caster for the convex polyhedron with given corners [m]."""
    faces = half_spaces(hull)

    def cast(origin: Float, directions: Float) -> Float:
        toward = directions @ faces[:, :3].T
        with np.errstate(divide="ignore", invalid="ignore"):
            crossing = (faces[:, 3] - faces[:, :3] @ origin) / toward
        entry = np.where(toward < 0, crossing, -np.inf).max(axis=1)
        leave = np.where(toward > 0, crossing, np.inf).min(axis=1)
        return np.asarray(np.where((entry <= leave) & (entry > 0), entry, np.inf))

    return cast


@dataclass(frozen=True, slots=True)
class _Errors:
    """How a cloud differs from hulls on a plane.

    Attributes:
        range_m: Standard deviation of ranges [m].
        ground_m: The same of heights of the ground [m].
        depth_m: Depth of the surface of stones below their hulls, along a ray [m].
        sunk_m: Height of the ground above the lowest point of a stone [m].
    """

    range_m: float
    ground_m: float
    depth_m: float = 0.0
    sunk_m: float = 0.0


def look_at(
    target: Solid,
    neighbours: tuple[Solid, ...],
    rng: np.random.Generator,
    views: Views = "mixed",
) -> StoneView:
    """Return what the sensors see of a stone at the origin.

    Args:
        target: The stone.
        neighbours: Other stones.
        rng: Random generator of places and noise of the sensors.
        views: `mixed`: two lidars and, in half of the scenes, a drone. `surveyed`: the lidars and
            the survey that a mission begins with, merged into a map.
    """
    if views == "surveyed":
        noise_m, sunk_m = rng.uniform(*_SURVEY_NOISE_M), rng.normal(*_SUNK_M)
        errors = _Errors(noise_m, _SURVEY_GROUND_NOISE_M, _ROUGH_M, sunk_m)
        sensors = _lidars(rng) + _flight(rng)
    else:
        errors = _Errors(rng.uniform(*_NOISE_M), _GROUND_NOISE_M)
        sensors = _lidars(rng) + (_drone(rng) if rng.random() < 0.5 else [])
    sights = [_sight((target, *neighbours), sensor, errors, rng) for sensor in sensors]
    points = np.concatenate([points for points, _ in sights])
    is_target = np.concatenate([of_target for _, of_target in sights]) & (points[:, 2] > _FOOT_M)
    stone = voxel_means(points[is_target], _MAP_CELL_M)
    return StoneView(stone, np.concatenate([stone, voxel_means(points[~is_target], _MAP_CELL_M)]))


def neighbour_place(rng: np.random.Generator) -> Float:
    """Draw the position of a neighbour relative to the stone [m], shape (3,)."""
    azimuth, distance = rng.uniform(0, 2 * np.pi), rng.uniform(*_NEIGHBOUR_M)
    return np.array([distance * np.cos(azimuth), distance * np.sin(azimuth), 0.0])


def _sight(
    solids: tuple[Solid, ...], sensor: Float, errors: _Errors, rng: np.random.Generator
) -> tuple[Float, Bool]:
    """Return the points that one sensor sees, and the mask of those on the first solid."""
    toward = (rng.random((_RAYS, 3)) - (0.5, 0.5, 0.0)) * 2 * _WINDOW_M * (1, 1, 0.5) - sensor
    directions = toward / np.linalg.norm(toward, axis=1, keepdims=True)
    with np.errstate(divide="ignore"):
        ground = np.where(directions[:, 2] < 0, -sensor[2] / directions[:, 2], np.inf)
    ranges = np.stack([*(solid(sensor, directions) for solid in solids), ground])
    first = ranges.argmin(axis=0)
    hit = ranges.min(axis=0)
    is_ground = first == len(solids)
    hit = hit + np.where(is_ground, 0.0, errors.depth_m)
    points = sensor + directions * (hit + rng.normal(0.0, errors.range_m, _RAYS))[:, None]
    raised = rng.normal(errors.sunk_m, errors.ground_m, _RAYS)
    points[:, 2] += np.where(is_ground, raised, 0.0)
    seen = np.isfinite(hit)
    return points[seen], first[seen] == 0


def _lidars(rng: np.random.Generator) -> list[Float]:
    radius, azimuth = rng.uniform(*_RADIUS_M), rng.uniform(0, 2 * np.pi)
    around = azimuth + rng.normal(0.0, _APART_RAD, _SIGHTS)
    return [
        np.array([radius * np.cos(a), radius * np.sin(a), rng.uniform(*_HEIGHT_M)]) for a in around
    ]


def _drone(rng: np.random.Generator) -> list[Float]:
    around = rng.uniform(0, 2 * np.pi) + np.arange(_SIGHTS) * 2 * np.pi / _SIGHTS
    return [
        np.array([_DRONE_RADIUS_M * np.cos(a), _DRONE_RADIUS_M * np.sin(a), _DRONE_HEIGHT_M])
        for a in around
    ]


def _flight(rng: np.random.Generator) -> list[Float]:
    """Draw where a drone takes its pictures: above a square around the stone."""
    xy = rng.uniform(-_FLIGHT_M, _FLIGHT_M, (_PICTURES, 2))
    return [np.append(place, _FLIGHT_HEIGHT_M) for place in xy]


def _flat(hull: Float) -> Float:
    """Return the rotation that turns the axis of least spread upwards."""
    corners = convex_corners(hull)
    _, axes = np.linalg.eigh(np.cov(corners.T))
    axes = axes[:, ::-1]
    axes[:, 0] *= np.sign(np.linalg.det(axes))
    return np.asarray(axes.T)
