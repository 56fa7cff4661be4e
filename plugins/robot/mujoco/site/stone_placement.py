"""Poses of stones: drawn with gaps, dropped, and settled."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np
from executive_plugins.physics.settling import come_to_rest
from executive_plugins.physics.surface import ContactModel
from executive_plugins.robot.mujoco.physics import apply_physics
from executive_plugins.robot.mujoco.physics_settings import PhysicsSettings
from executive_plugins.robot.mujoco.site.settings import PlacementSettings
from executive_plugins.robot.mujoco.site.stone_model import StoneModel
from executive_plugins.robot.mujoco.site.terrain import Terrain
from scipy.spatial import ConvexHull

from executive.arrays import Float
from executive.errors import ConfigError
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import about_axis, exp_so3, from_quaternion
from executive.machine.lift_capacity import LiftCapacity

_TRIES = 200  # draws of the place of one stone before a new arrangement is begun
_ARRANGEMENTS = 30  # before a site counts as full: 120 drawn sites needed 10 at most, one 23
_TILT_RAD = 0.15  # standard deviation of the tilt at the drop
_CLEARANCE_M = 0.02  # height above the ground at the drop
_ROLL_M = 0.15  # added to the gap, since stones roll slightly when they are dropped
_SETTLING_S = (0.5, 8.0)  # least and longest time for settling


@dataclass(frozen=True, slots=True)
class Grounds:
    """Where stones may lie.

    Attributes:
        terrain: The ground.
        settings: The sector, and the gaps.
        reach_m: Reach of the machine, for radii that are not given.
        capacity: What the machine may lift where; stones lie anywhere in the sector if None.
        station_m: Middle of the sector, where the machine will stand, (x, y) [m].
        taken: Outlines from above of what stands there already [m], (K, 2) each.
    """

    terrain: Terrain
    settings: PlacementSettings
    reach_m: float
    capacity: LiftCapacity | None
    station_m: tuple[float, float] = (0.0, 0.0)
    taken: tuple[Float, ...] = ()

    def at(self, station_m: tuple[float, float]) -> "Grounds":
        """Return the same about another place of the machine, (x, y) [m]."""
        return replace(self, station_m=station_m)


class _NoRoomError(Exception):
    """No room for the next stone in this arrangement; another one may have it."""


def place(
    stones: Sequence[StoneModel],
    grounds: Grounds,
    physics: PhysicsSettings,
    contact: ContactModel,
    rng: np.random.Generator,
) -> tuple[Float, ...]:
    """Return the poses of the stones at rest, T_world_stone each.

    With a lift capacity, each stone lies where the machine may lift it. A stone that does keeps the
    place that it has without.

    Raises:
        ConfigError: If there is no room for them, or one does not come to rest; the message says
            what to change.
    """
    gap_m, capacity = grounds.settings.gap_m, grounds.capacity
    for _ in range(_ARRANGEMENTS):
        try:
            drops = _arrangement(stones, grounds, rng)
        except _NoRoomError:
            continue
        rest = _settle(stones, drops, grounds.terrain, physics, contact)
        if rest and _gaps_hold(stones, rest, gap_m):
            return rest
    within = "" if capacity is None else " within the machine's lift capacity"
    raise ConfigError(
        f"robot.site.stones: no room for {len(stones)} stones with {gap_m} m "
        f"between them{within}; "
        "lower count or gap_m, or widen placement.sector_width_rad or placement.max_radius_m"
    )


def _arrangement(
    stones: Sequence[StoneModel],
    grounds: Grounds,
    rng: np.random.Generator,
) -> tuple[Float, ...]:
    """Place the stones one by one with gaps (random sequential insertion)."""
    elsewhere = rng.spawn(1)[0]
    placed: list[Float] = []
    outlines: list[Float] = list(grounds.taken)
    stations = grounds.settings.stations_m
    for i, stone in enumerate(stones):
        for _ in range(_TRIES):
            T = _liftable(stone, grounds.at(stations[i % len(stations)]), rng, elsewhere)
            outline = footprint(transform(T, stone.hull))
            if all(
                _is_clear(outline, other, grounds.settings.gap_m + _ROLL_M) for other in outlines
            ):
                break
        else:
            raise _NoRoomError
        placed.append(T)
        outlines.append(outline)
    return tuple(placed)


def _liftable(
    stone: StoneModel,
    grounds: Grounds,
    rng: np.random.Generator,
    elsewhere: np.random.Generator,
) -> Float:
    """Draw a pose; where the machine may not lift the stone, draw others from `elsewhere`."""
    T = _draw(stone, grounds, rng)
    for _ in range(_TRIES):
        if _may_be_lifted(stone, T, grounds):
            return T
        T = _draw(stone, grounds, elsewhere)
    raise ConfigError(
        f"robot.site.stones: {stone.name} weighs {stone.mass_kg:.0f} kg, which the machine may "
        "lift nowhere in the sector of the placement (ISO 10567); lower volume_m3, density_kg_m3 "
        "or placement.min_radius_m"
    )


def _draw(
    stone: StoneModel,
    grounds: Grounds,
    rng: np.random.Generator,
) -> Float:
    """Draw a pose above the ground.

    The shortest axis is up except for a tilt, as for stones that were unloaded.
    """
    terrain, settings, reach_m = grounds.terrain, grounds.settings, grounds.reach_m
    least = 0.45 * reach_m if settings.min_radius_m is None else settings.min_radius_m
    most = 0.75 * reach_m if settings.max_radius_m is None else settings.max_radius_m
    if least > most:
        raise ConfigError(
            f"robot.site.stones.placement: min_radius_m {least:g} is beyond max_radius_m {most:g}"
        )
    radius = np.sqrt(rng.uniform(least**2, most**2))  # uniform over the area
    azimuth = settings.sector_centre_rad + settings.sector_width_rad * rng.uniform(-0.5, 0.5)
    tilt = exp_so3(np.append(rng.normal(0.0, _TILT_RAD, 2), 0.0))
    R = about_axis(np.array([0.0, 0.0, 1.0]), rng.uniform(0, 2 * np.pi)) @ tilt @ _flat(stone)
    x, y = grounds.station_m
    place = np.array([x + radius * np.cos(azimuth), y + radius * np.sin(azimuth), 0.0])
    corners = stone.hull @ R.T + place
    place[2] = (terrain.height_at(corners[:, :2]) - corners[:, 2]).max() + _CLEARANCE_M
    return pose(R, place)


def _may_be_lifted(stone: StoneModel, T_world_stone: Float, grounds: Grounds) -> bool:
    x, y = T_world_stone[:2, 3] - grounds.station_m
    if grounds.capacity is None:
        return True
    there = grounds.capacity.near(float(np.hypot(x, y)), float(np.arctan2(y, x)))
    return there is not None and there.rated_kg >= stone.mass_kg


def _flat(stone: StoneModel) -> Float:
    """Return the rotation that turns the shortest axis, that of largest inertia, upwards."""
    _, axes = np.linalg.eigh(stone.inertia)
    axes[:, 0] *= np.sign(np.linalg.det(axes))
    return np.asarray(axes.T)


def footprint(corners: Float) -> Float:
    """Return the convex outline from above, counter-clockwise, shape (K, 2)."""
    return np.asarray(corners[ConvexHull(corners[:, :2]).vertices, :2])


def gap(outline_a: Float, outline_b: Float) -> float:
    """Return the distance of two convex outlines [m]; 0 if they overlap."""
    if not _is_apart(outline_a, outline_b) and not _is_apart(outline_b, outline_a):
        return 0.0
    return min(_corner_to_edges(outline_a, outline_b), _corner_to_edges(outline_b, outline_a))


def _is_clear(outline: Float, other: Float, gap_m: float) -> bool:
    """Return whether two outlines keep a distance; their bounding boxes are compared first."""
    lower = np.maximum(outline.min(axis=0), other.min(axis=0))
    upper = np.minimum(outline.max(axis=0), other.max(axis=0))
    return bool((lower - upper >= gap_m).any()) or gap(outline, other) >= gap_m


def _is_apart(outline: Float, other: Float) -> bool:
    """Return whether an edge of the outline separates the two (separating axis theorem)."""
    edges = np.roll(outline, -1, axis=0) - outline
    outward = np.c_[edges[:, 1], -edges[:, 0]]
    return bool((((other[:, None, :] - outline) * outward).sum(axis=2).min(axis=0) > 0).any())


def _corner_to_edges(corners: Float, outline: Float) -> float:
    ends = np.roll(outline, -1, axis=0)
    along = ends - outline
    fraction = ((corners[:, None, :] - outline) * along).sum(axis=2) / (along**2).sum(axis=1)
    nearest = outline + np.clip(fraction, 0, 1)[..., None] * along
    return float(np.linalg.norm(corners[:, None, :] - nearest, axis=2).min())


def _gaps_hold(stones: Sequence[StoneModel], poses: Sequence[Float], gap_m: float) -> bool:
    outlines = [footprint(transform(T, stone.hull)) for stone, T in zip(stones, poses, strict=True)]
    return all(gap(a, b) >= gap_m for i, a in enumerate(outlines) for b in outlines[:i])


def _settle(
    stones: Sequence[StoneModel],
    drops: Sequence[Float],
    terrain: Terrain,
    physics: PhysicsSettings,
    contact: ContactModel,
) -> tuple[Float, ...]:
    """Let the stones fall; return their poses at rest, empty if one is still moving in the end."""
    spec = mujoco.MjSpec()
    terrain.add_to(spec)
    for stone, T in zip(stones, drops, strict=True):
        stone.add_to(spec, T)
    apply_physics(spec, physics, contact)
    model = spec.compile()
    data = mujoco.MjData(model)
    if not come_to_rest(model, data, *_SETTLING_S):
        return ()
    return tuple(pose(from_quaternion(q[3:]), q[:3]) for q in data.qpos.reshape(-1, 7))
