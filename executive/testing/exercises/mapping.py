"""Mapping: pairs of scans of ground and a wall, and scans that show nothing."""

from collections.abc import Callable, Mapping
from typing import TypedDict

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import inverse, pose, transform
from executive.interfaces.mapping import Mapper
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine
from executive.messages.lidar import LidarScan
from executive.messages.motion import Motion
from executive.messages.sector import Sector
from executive.testing.digest import locked
from executive.testing.exercise import Exercise
from executive.testing.exercises.useless_clouds import with_each_cloud

T_MAP_CABIN = pose(None, np.array([1.0, 2.0, 1.4]))
CENTRE = np.array([6.0, 2.0, 0.0])  # on the ground in view


def joints(machine: Machine) -> Float:
    """Return the positions of all joints, the jaws closed."""
    return np.append(machine.posture("scan"), 0.0)


def lidars(machine: Machine) -> tuple[str, ...]:
    """Return the machine's lidars, in the order in which a mission hands over their scans."""
    return tuple(sensor.name for sensor in machine.sensors_of("lidar"))


def surface(seed: int) -> Float:
    """Return ground in front of the machine, and a wall [m]."""
    rng = np.random.default_rng(seed)
    ground = np.column_stack([rng.uniform(4, 8, 9000), rng.uniform(-2, 6, 9000), np.zeros(9000)])
    wall = np.column_stack([np.full(4000, 8.0), rng.uniform(-2, 6, 4000), rng.uniform(0, 2, 4000)])
    return np.vstack([ground, wall])


def pair(machine: Machine, stamp_s: float, seed: int) -> list[LidarScan]:
    """Return a scan of each lidar, from where the cabin stands."""
    frames = Kinematics(machine).frames(joints(machine)[:-1])
    T_cabin_base = inverse(frames[machine.cabin_link])
    scans = []
    for k, lidar in enumerate(lidars(machine)):
        T_lidar_map = inverse(T_MAP_CABIN @ T_cabin_base @ frames[lidar])
        points = transform(T_lidar_map, surface(2 * seed + k))
        stamps = np.linspace(stamp_s - 0.1, stamp_s, len(points))
        scans.append(LidarScan(stamp_s, lidar, points, stamps))
    return scans


def motion(machine: Machine, stamp_s: float) -> Motion:
    """Return a cabin at rest during a scan."""
    stamps = np.linspace(stamp_s - 0.15, stamp_s, 4)
    cabin, position = np.repeat(T_MAP_CABIN[None], 4, 0), np.repeat(joints(machine)[None], 4, 0)
    return Motion(stamps, cabin, machine.joint_names, position)


def filled(mapper: Mapper, machine: Machine) -> Mapper:
    """Return the mapper after four pairs."""
    for k in range(4):
        stamp_s = 1 + 0.1 * k
        mapper.add_scan_pair(pair(machine, stamp_s, k), motion(machine, stamp_s))
    return mapper


class MappingInputs(TypedDict):
    """Scans, the motions in which they were taken, and where to look."""

    pairs: tuple[tuple[LidarScan, ...], ...]
    motions: tuple[Motion, ...]
    centre_map: Float
    sector: Sector
    points_map: Float


class MappingExercise(Exercise[Mapper, MappingInputs]):
    """Two pairs, a sphere out, its surface in, and a pair while something is held."""

    def inputs(self, machine: Machine) -> MappingInputs:
        stamps = (1.0, 1.1, 1.2)
        return {
            "pairs": tuple(tuple(pair(machine, t, k)) for k, t in enumerate(stamps)),
            "motions": tuple(motion(machine, t) for t in stamps),
            "centre_map": locked(CENTRE),
            "sector": Sector(T_MAP_CABIN[:2, 3].copy(), 0.0, 0.6, 3.5, 6.5),
            "points_map": locked(CENTRE + np.random.default_rng(0).uniform(-0.5, 0.5, (500, 3))),
        }

    def run(self, plugin: Mapper, inputs: MappingInputs) -> object:
        *before, while_held = zip(inputs["pairs"], inputs["motions"], strict=True)
        kept = [plugin.add_scan_pair(scans, moved) for scans, moved in before]
        removed = plugin.remove_sphere(inputs["centre_map"], 1.0)
        plugin.add_surface(inputs["points_map"])
        plugin.mask_held(0.5)
        kept.append(plugin.add_scan_pair(*while_held))
        share = plugin.dense_share(inputs["sector"], 20.0)
        return kept, removed, share, plugin.cloud(), plugin.held()

    def hostile(self, machine: Machine) -> Mapping[str, Callable[[Mapper], object]]:
        name, nan = lidars(machine)[0], np.full(3, np.nan)

        def added(points: Float, stamp_s: float = 1.0) -> Callable[[Mapper], object]:
            scan = LidarScan(stamp_s, name, points, np.full(len(points), stamp_s))
            return lambda mapper: (
                mapper.add_scan_pair([scan], motion(machine, 1.0)),
                mapper.cloud(),
            )

        return {
            **with_each_cloud(lambda mapper, cloud: added(cloud.points)(mapper), "as a scan"),
            **with_each_cloud(lambda mapper, cloud: mapper.add_surface(cloud.points), "as surface"),
            "no scans": lambda mapper: mapper.add_scan_pair([], motion(machine, 1.0)),
            "a scan long after its motion": added(np.array(surface(0)), 3600.0),
            "a sphere that is not finite": lambda mapper: mapper.remove_sphere(nan, 1.0),
            "a sphere in an empty map": lambda mapper: mapper.remove_sphere(CENTRE, 1.0),
            "a sphere of no size": lambda mapper: mapper.remove_sphere(CENTRE, 0.0),
            "a sector that is too small": lambda mapper: mapper.dense_share(
                Sector(np.zeros(2), 0.0, 0.01, 2.0, 2.1), 1.0
            ),
            "a surface of another shape": lambda mapper: mapper.add_surface(np.zeros((5, 2))),
            "a surface that is not finite": lambda mapper: mapper.add_surface(nan[None]),
        }
