"""Spinning lidars: one revolution is cast column by column, each at its own time, while everything moves."""

from functools import cache

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import inverse
from executive.messages.lidar import LidarScan
from plugins.robot.mujoco.firing_pattern import FiringPattern, firing_pattern
from plugins.robot.mujoco.machine_skin import MachineSkin
from plugins.robot.mujoco.pose_history import PoseHistory
from plugins.robot.mujoco.ray_mesh import Mesh, RayMesh, Rays, moved
from plugins.robot.mujoco.scene import SiteScene
from robot_models.sensor import Lidar

_SLICES = 4  # of a revolution: the arm and stones under way stand still within one (25 ms; 1 cm at 0.4 m/s)
_PHASES = 4  # firing is not locked to the angle: a revolution begins at one of so many fractions of a column


class SpinningLidar:
    """One lidar of the machine.

    What stands still on the site is cast with the pose of each firing column. What moves against it (other links,
    stones under way) is cast in the lidar's own frame, a slice of the revolution at a time. The carrying link never
    moves in that frame: it is cast once and for all, and taken to be in front of everything else. All lasers of a
    column fire at once: the 55 µs from first to last would turn the beam by 0.2 deg.
    """

    def __init__(
        self, lidar: Lidar, stride: int, skin: MachineSkin, scene: SiteScene, rng: np.random.Generator
    ) -> None:
        self.lidar = lidar
        self._skin = skin
        self._scene = scene
        self._rng = rng
        self._columns = round(2 * np.pi / (lidar.azimuth_step_rad * stride))
        self._pattern = cache(self._make_pattern)

    def _make_pattern(self, phase: int) -> FiringPattern:
        return firing_pattern(self.lidar, self._columns, phase / _PHASES, self._skin.mesh(self.lidar.link))

    def scan(self, history: PoseHistory, end_s: float, stone_names: tuple[str, ...]) -> LidarScan:
        """Measure the revolution that ends at a time [s]; the history covers all of it."""
        pattern = self._pattern(int(self._rng.integers(_PHASES)))
        times = end_s - (1 - np.arange(self._columns) / self._columns) / self.lidar.rate_hz
        ranges = pattern.own_range_m.copy()
        ranges[pattern.free] = np.minimum(
            self._cast_site(pattern, times, history), self._cast_movers(pattern, times, history, stone_names)
        )
        return self._measure(pattern, ranges, times, end_s)

    def _measure(self, pattern: FiringPattern, ranges: Float, times: Float, end_s: float) -> LidarScan:
        nearest, farthest = self.lidar.range_m
        hit = np.flatnonzero((ranges >= nearest) & (ranges <= farthest))
        measured = ranges[hit] + self._rng.normal(0.0, self.lidar.range_noise_m, len(hit))
        points = pattern.directions.reshape(-1, 3)[hit] * measured[:, None]
        return LidarScan(end_s, self.lidar.name, points, times[hit // self.lidar.lasers])

    def _cast_site(self, pattern: FiringPattern, times: Float, history: PoseHistory) -> Rays:
        """Return the ranges of the free rays to all that rests."""
        T_link_lidar = self.lidar.T_link_sensor
        t_world_link, R_world_link = history.track(self.lidar.link, times)
        R_world_lidar = R_world_link @ T_link_lidar[:3, :3]
        rays = np.empty((*pattern.directions.shape[:2], 6), dtype=np.float32)
        rays[..., :3] = (t_world_link + R_world_link @ T_link_lidar[:3, 3])[:, None, :]
        rays[..., 3:] = pattern.directions @ R_world_lidar.transpose(0, 2, 1).astype(np.float32)
        return self._scene.cast_resting(rays.reshape(-1, 6)[pattern.free])

    def _cast_movers(
        self, pattern: FiringPattern, times: Float, history: PoseHistory, stone_names: tuple[str, ...]
    ) -> Rays:
        """Return the ranges of the free rays to all that moves."""
        ends = np.searchsorted(pattern.free, np.arange(1, _SLICES) * len(pattern.own_range_m) // _SLICES)
        middles = times[(2 * np.arange(_SLICES) + 1) * len(times) // (2 * _SLICES)]
        return np.concatenate(
            [
                RayMesh(self._movers(history.poses(float(middle_s)), stone_names)).cast(part)
                for part, middle_s in zip(np.split(pattern.free_rays, ends), middles, strict=True)
            ]
        )

    def _movers(self, T_world: dict[str, Float], stone_names: tuple[str, ...]) -> list[Mesh]:
        """Return other links and stones under way, in the lidar's frame."""
        T_world_lidar = T_world[self.lidar.link] @ self.lidar.T_link_sensor
        T_lidar_world = inverse(T_world_lidar)
        stones = [moved(self._scene.skin(i), T_lidar_world @ T_world[stone_names[i]]) for i in self._scene.moving]
        return self._skin.others(self.lidar.link, T_world, T_world_lidar) + stones
