"""The self-filter against the shapes of the links, tested point by point in the base frame."""

from collections.abc import Mapping

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from executive.arrays import Bool, Float
from executive.geometry.pose import inverse, transform
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine, load_machine
from executive.machine.self_filter import SelfFilter, _is_behind

PADDING_M, SHADOW_M = 0.1, 0.02


@pytest.fixture(scope="module", params=[pytest.param("m545", marks=pytest.mark.slow), "mini"])
def machine(request: pytest.FixtureRequest) -> Machine:
    return load_machine(request.param)


def some_frames(machine: Machine, seed: int) -> Mapping[str, Float]:
    """Return the frames of a random posture near the one for scanning."""
    rng = np.random.default_rng(seed)
    posture = machine.posture("scan")
    arm = np.clip(posture + rng.normal(0, 0.3, len(posture)), machine.lower, machine.upper)
    return Kinematics(machine).frames(arm, 0.5 * machine.jaw.open_rad)


def padded_hulls(
    machine: Machine, frames: Mapping[str, Float], padding_m: float
) -> list[tuple[str, Float]]:
    """Return link and half-spaces n·p ≤ d of each shape in the base frame, shape (P, 4)."""
    hulls = []
    for name, link in machine.links.items():
        for shape in link.shapes:
            equations = ConvexHull(transform(frames[name], shape.vertices)).equations
            hulls.append((name, np.c_[equations[:, :3], padding_m - equations[:, 3]]))
    return hulls


def is_inside(points: Float, planes: Float) -> Bool:
    return (points @ planes[:, :3].T <= planes[:, 3]).all(axis=-1)


def near_points(machine: Machine, frames: Mapping[str, Float], seed: int, count: int) -> Float:
    """Return points in the base frame around the links, within half a metre of their vertices."""
    rng = np.random.default_rng(seed)
    vertices = np.vstack(
        [
            transform(frames[name], shape.vertices)
            for name, link in machine.links.items()
            for shape in link.shapes
        ]
    )
    return vertices[rng.integers(len(vertices), size=count)] + rng.uniform(-0.5, 0.5, (count, 3))


def found(
    self_filter: SelfFilter,
    frames: Mapping[str, Float],
    lidar: str,
    points_base: Float,
    held_radius_m: float = 0.0,
) -> Bool:
    points_lidar = transform(inverse(frames[lidar]), points_base)
    slices = np.zeros(len(points_base), dtype=np.int64)
    return self_filter.inside(points_lidar, slices, lidar, [frames], held_radius_m)


def test_without_shadows_the_returns_found_are_those_in_a_padded_hull(machine: Machine) -> None:
    for seed, lidar in enumerate(sensor.name for sensor in machine.sensors_of("lidar")):
        frames = some_frames(machine, seed)
        points = near_points(machine, frames, seed, 1000)
        hulls = padded_hulls(machine, frames, PADDING_M)
        expected = np.any([is_inside(points, planes) for _, planes in hulls], axis=0)
        assert 0.1 < expected.mean() < 0.9
        assert (found(SelfFilter(machine, PADDING_M), frames, lidar, points) == expected).all()


def test_a_shadow_is_where_the_ray_passes_a_link_other_than_the_sensors(machine: Machine) -> None:
    """Rays are sampled every centimetre; one that grazes a hull by less than 1 cm is not tested."""
    for seed, sensor in enumerate(machine.sensors_of("lidar")):
        frames = some_frames(machine, seed + 10)
        origin = frames[sensor.name][:3, 3]
        near = near_points(machine, frames, seed + 10, 60)
        points = origin + np.random.default_rng(seed).uniform(1.0, 2.5, (60, 1)) * (near - origin)
        steps = np.linspace(0, 1, 1500)[:, None, None]
        rays = origin + steps * (points - origin)
        surely, possibly = np.zeros(len(points), dtype=bool), np.zeros(len(points), dtype=bool)
        for grown_m, into in ((-0.01, surely), (0.01, possibly)):
            for name, planes in padded_hulls(machine, frames, SHADOW_M + grown_m):
                if name != sensor.link and not is_inside(origin, planes):
                    into |= is_inside(rays, planes).any(axis=0)
            for _, planes in padded_hulls(machine, frames, PADDING_M + grown_m):
                into |= is_inside(points, planes)
        filtered = found(SelfFilter(machine, PADDING_M, SHADOW_M), frames, sensor.name, points)
        assert surely.mean() > 0.1
        assert possibly.mean() < 0.95
        assert filtered[surely].all()
        assert not filtered[~possibly].any()


def test_a_held_stone_is_the_ball_around_the_grasp_centre(machine: Machine) -> None:
    for seed, lidar in enumerate(sensor.name for sensor in machine.sensors_of("lidar")):
        frames = some_frames(machine, seed + 20)
        centre = transform(frames["gripper"], machine.gripper.grasp_centre)
        rng = np.random.default_rng(seed)
        points = centre + rng.normal(0, 0.6, (2000, 3))
        self_filter = SelfFilter(machine, PADDING_M)
        by_links = found(self_filter, frames, lidar, points)
        with_ball = found(self_filter, frames, lidar, points, held_radius_m=0.8)
        is_in_ball = np.linalg.norm(points - centre, axis=1) <= 0.8
        assert (with_ball == (by_links | is_in_ball)).all()
        assert (is_in_ball & ~by_links).sum() > 100
        assert (~is_in_ball & ~by_links).sum() > 100


def test_each_point_is_tested_with_the_posture_of_its_own_time(machine: Machine) -> None:
    lidar = machine.sensors_of("lidar")[0].name
    postures = [some_frames(machine, seed) for seed in (30, 31)]
    points = near_points(machine, postures[0], 30, 1000)
    points_lidar = transform(inverse(postures[0][lidar]), points)
    slices = np.arange(1000) % 2
    self_filter = SelfFilter(machine, PADDING_M)
    together = self_filter.inside(points_lidar, slices, lidar, postures, 0.0)
    for k, frames in enumerate(postures):
        alone = self_filter.inside(
            points_lidar[slices == k], np.zeros(500, dtype=np.int64), lidar, [frames], 0.0
        )
        assert (together[slices == k] == alone).all()


def slab(y: float) -> Float:
    """A cube of 2 m with its middle at (5, y, 0) as half-spaces n·p ≤ d, shape (6, 4)."""
    middle = np.array([5.0, y, 0.0])
    sides = np.vstack([np.eye(3), -np.eye(3)])
    return np.column_stack([sides, sides @ middle + 1.0])


@pytest.mark.parametrize(
    ("point", "y", "inset_m", "is_shaded"),
    [
        ((10.0, 0.0, 0.0), 0.0, 0.0, True),
        ((5.0, 0.0, 0.0), 0.0, 0.0, True),  # it enters the cube before the point
        ((3.9, 0.0, 0.0), 0.0, 0.0, False),  # the point is in front
        ((10.0, 0.0, 0.0), 3.0, 0.0, False),  # along a side, outside
        ((10.0, 0.0, 0.0), -3.0, 0.0, False),
        ((10.0, 0.0, 0.0), 0.95, 0.0, True),  # along a side, inside
        ((10.0, 0.0, 0.0), 0.95, 0.1, False),  # and outside the cube that is shrunken
        ((-10.0, 0.0, 0.0), 0.0, 0.0, False),  # the other way
        ((10.0, 2.6, 0.0), 0.0, 0.0, False),  # past a corner
        ((10.0, 2.4, 0.0), 0.0, 0.0, True),  # through a corner
    ],
)
def test_a_point_is_shaded_if_its_ray_crosses_the_shape(point, y, inset_m, is_shaded) -> None:
    assert _is_behind(np.array(point), slab(y), 0, 6, inset_m) == is_shaded


def test_a_shape_around_the_sensor_casts_no_shadow() -> None:
    planes = slab(0.0)
    planes[:, 3] -= planes[:, :3] @ [5.0, 0.0, 0.0]  # around the origin
    assert not _is_behind(np.array([10.0, 1.0, 2.0]), planes, 0, 6, 0.0)
