"""Spinning lidars: the columns of a revolution are cast at their own times, during motion."""

from collections.abc import Mapping
from functools import cache

import numpy as np
from executive_plugins.robot.mujoco.sensors.articulated_mesh import ArticulatedMesh
from executive_plugins.robot.mujoco.sensors.beams import (
    beams_in_world,
    beams_towards,
    compile_beams,
    returned_points,
)
from executive_plugins.robot.mujoco.sensors.firing_pattern import FiringPattern, firing_pattern
from executive_plugins.robot.mujoco.sensors.pose_history import PoseHistory
from executive_plugins.robot.mujoco.site.ray_mesh import Mesh, RayMesh, Rays
from executive_plugins.robot.mujoco.site.site_scene import SiteScene

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.machine.sensor import Lidar
from executive.messages.lidar import LidarScan

# Slices of a revolution; arm and moving stones are fixed within one (33 ms; ±1 cm at 0.6 m/s).
_SLICES = 3
# Firing is not synchronised with the angle: a revolution begins at a multiple of this fraction of a
# column.
_PHASES = 4
# About the boxes of moving objects, against rounding in single precision: 1e-5 of 100 m.
_MARGIN_M = 1e-3


class SpinningLidar:
    """One lidar of the machine.

    Objects that rest on the site are cast with the pose of each firing column. Moving objects
    (other links, moving stones) are cast in the lidar's own frame, one slice of the revolution at a
    time. The carrying link never moves in that frame: it is cast once, and is assumed to be in
    front of everything else. All lasers of a column fire at once; the real 55 µs from first to last
    would turn the beam by 0.2 deg.
    """

    def __init__(
        self,
        lidar: Lidar,
        stride: int,
        skin: Mapping[str, Mesh],
        scene: SiteScene,
        history: PoseHistory,
        rng: np.random.Generator,
    ) -> None:
        self.lidar = lidar
        self._scene = scene
        self._history = history
        self._rng = rng
        self._columns = round(2 * np.pi / (lidar.azimuth_step_rad * stride))
        self._own = [skin[lidar.link]] if lidar.link in skin else []
        self._others = [
            (history.index(name), mesh) for name, mesh in skin.items() if name != lidar.link
        ]
        self._pattern = cache(self._make_pattern)
        compile_beams()

    def _make_pattern(self, phase: int) -> FiringPattern:
        return firing_pattern(self.lidar, self._columns, phase / _PHASES, self._own)

    def scan(self, end_s: float) -> LidarScan:
        """Measure the revolution that ends at a time [s]; the history must cover it."""
        pattern = self._pattern(int(self._rng.integers(_PHASES)))
        times = end_s - (1 - np.arange(self._columns) / self._columns) / self.lidar.rate_hz
        ranges = pattern.own_range_m.copy()
        ranges[pattern.free] = np.minimum(
            self._cast_site(pattern, times), self._cast_movers(pattern, times)
        )
        return self._measure(pattern, ranges, times, end_s)

    def _measure(
        self, pattern: FiringPattern, ranges: Float, times: Float, end_s: float
    ) -> LidarScan:
        nearest, farthest = self.lidar.range_m
        hit = np.flatnonzero((ranges >= nearest) & (ranges <= farthest))
        measured = ranges[hit] + self._rng.normal(0.0, self.lidar.range_noise_m, len(hit))
        points = returned_points(pattern.directions, hit, measured)
        return LidarScan(end_s, self.lidar.name, points, times[hit // self.lidar.lasers])

    def _cast_site(self, pattern: FiringPattern, times: Float) -> Rays:
        """Return the ranges of the free rays to all resting objects."""
        T_link_lidar = self.lidar.T_link_sensor
        t_world_link, R_world_link = self._history.track(self.lidar.link, times)
        R_world_lidar = R_world_link @ T_link_lidar[:3, :3]
        origins = t_world_link + R_world_link @ T_link_lidar[:3, 3]
        rays = beams_in_world(pattern.directions, pattern.free, origins, R_world_lidar)
        return self._scene.cast_resting(rays)

    def _cast_movers(self, pattern: FiringPattern, times: Float) -> Rays:
        """Return the ranges of the free rays to other links and moving stones."""
        stones = [
            (self._history.index(self._scene.name(i)), self._scene.skin(i))
            for i in self._scene.moving
        ]
        movers = ArticulatedMesh.of(self._others + stones)
        link = self._history.index(self.lidar.link)
        ends = np.searchsorted(
            pattern.free, np.arange(1, _SLICES) * len(pattern.own_range_m) // _SLICES
        )
        middles = times[(2 * np.arange(_SLICES) + 1) * len(times) // (2 * _SLICES)]
        rays = np.split(pattern.free_rays, ends)
        inverse = np.split(pattern.free_inverse, ends, axis=1)
        ranges = []
        for part, own, middle_s in zip(rays, inverse, middles, strict=True):
            positions, rotations = self._history.poses(float(middle_s))
            T_world_lidar = pose(rotations[link], positions[link]) @ self.lidar.T_link_sensor
            mesh = movers.posed(positions, rotations, T_world_lidar)
            ranges.append(_cast(part, own, mesh, movers.boxes(mesh[0])))
        return np.concatenate(ranges)


def _cast(rays: Rays, inverse: Rays, mesh: Mesh, boxes: tuple[Float, Float]) -> Rays:
    """Return the ranges of rays from the origin to a mesh, inf for none, shape (N,).

    Only those are cast that pass through one of the boxes in which the parts of the mesh lie.
    """
    ranges = np.full(len(rays), np.inf, dtype=np.float32)
    low, high = (boxes[0] - _MARGIN_M).astype(np.float32), (boxes[1] + _MARGIN_M).astype(np.float32)
    near = np.flatnonzero(beams_towards(np.ascontiguousarray(inverse), low, high))
    if len(near):
        ranges[near] = RayMesh([mesh]).cast(rays[near])
    return ranges
