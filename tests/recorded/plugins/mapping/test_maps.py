"""Both maps over a swing in a yard: a held stone, a removed sphere, a surface, and a drive away."""

import numpy as np
import pytest
from executive_plugins.mapping.pose_graph import PoseGraph
from executive_plugins.mapping.scan_front_end import ScanFrontEnd
from executive_plugins.mapping.settings import PoseGraphSettings, VoxelMapSettings
from executive_plugins.mapping.voxel_map import VoxelMap

from executive.errors import DataError
from executive.messages.lidar import LidarScan
from executive.messages.motion import Motion
from executive.messages.sector import Sector

COARSE = {"voxel_m": 0.25, "smoothing_m": 0.3, "radius_m": 6.0, "min_points": 2}
COLUMNS = 90


def pair(yard, stamp_s: float) -> list[LidarScan]:
    return [
        yard.scan("lidar_vertical", stamp_s, COLUMNS),
        yard.scan("lidar_horizontal", stamp_s - 0.03, COLUMNS),
    ]


def shifted(motion: Motion, x: float) -> Motion:
    T = motion.T_map_cabin.copy()
    T[:, 0, 3] += x
    return Motion(motion.stamps_s, T, motion.joint_names, motion.joint_position, motion.covariance)


def driven(mapper, yard) -> list[object]:
    told: list[object] = []
    mapper.start()
    sector = Sector(np.zeros(2), 0.5, 2.0, 2.0, 5.0)
    for k in range(8):
        stamp_s = 1.0 + 0.1 * k
        told.append(mapper.add_scan_pair(pair(yard, stamp_s), yard.motion(stamp_s)))
    told += [mapper.cloud(), mapper.dense_share(sector, 3.0)]
    told.append(mapper.remove_sphere(np.array([3.0, 1.0, 0.0]), 1.5))
    mapper.mask_held(0.0)
    mapper.mask_held(1.5)
    mapper.add_surface(np.random.default_rng(1).uniform(-7, 7, (80, 3)))
    told.append(mapper.cloud())
    told.append(mapper.add_scan_pair([], yard.motion(2.0)))
    for k in range(3):
        stamp_s = 2.0 + 0.1 * k
        told.append(
            mapper.add_scan_pair(pair(yard, stamp_s), shifted(yard.motion(stamp_s), 0.4 * (k + 1)))
        )
    told += [mapper.cloud(), mapper.dense_share(sector, 3.0)]
    refusals = []
    for call in (
        lambda: mapper.mask_held(-0.1),
        lambda: mapper.add_scan_pair(
            [LidarScan(3.0, "lidar_diagonal", np.ones((1, 3)), np.ones(1))], yard.motion(3.0)
        ),
    ):
        with pytest.raises(DataError) as refused:
            call()
        refusals.append(refused.value)
    mapper.close()
    return [*told, refusals]


@pytest.mark.parametrize("changed", [{}, {"smoothing_m": 0.0, "nearest_m": 4.0, "memory": 2}])
@pytest.mark.parametrize("rate_rad_s", [0.0, 0.5])
def test_voxel_map(recorded, machine, make_yard, rate_rad_s, changed) -> None:
    settings = VoxelMapSettings(**{**COARSE, **changed})
    recorded(driven(VoxelMap(settings, machine), make_yard(rate_rad_s, 0.02)))


@pytest.mark.parametrize(
    "changed", [{}, {"pairs_at_rest": 2, "travel_m": 0.2, "odometry": {"anchor_period_s": 0.3}}]
)
@pytest.mark.parametrize("rate_rad_s", [0.0, 0.5])
def test_pose_graph(recorded, machine, make_yard, rate_rad_s, changed) -> None:
    settings = PoseGraphSettings(**COARSE, **changed, window=20)
    # The matching and the graph stop at tolerances of their own.
    told = driven(PoseGraph(settings, machine), make_yard(rate_rad_s, 0.02))
    recorded(told, relative=1e-6)


def test_front_end(recorded, machine, make_yard) -> None:
    yard = make_yard(0.5)
    front_end = ScanFrontEnd(machine, VoxelMapSettings(padding_m=0.3, shadow_m=0.0))
    empty = LidarScan(1.0, "lidar_vertical", np.empty((0, 3)), np.empty(0))
    motion = yard.motion(1.0)
    lacking = Motion(
        motion.stamps_s, motion.T_map_cabin, motion.joint_names[1:], motion.joint_position[:, 1:]
    )
    told = [front_end.place(empty, motion, 0.0), front_end.lidars_map(motion, 0.97)]
    told.append(front_end.place(yard.scan("lidar_vertical", 1.0, 40), motion, 0.0))
    with pytest.raises(DataError) as refused:
        front_end.lidars_map(lacking, 1.0)
    recorded((told, refused.value))
