"""A map of voxels on the state estimate's word: filter, undistort, average (Mascaro 2020, Sec. 4.2).

Deviation from the paper: no scan matching and no pose graph. The machine stands still while it works and its state
estimate is good to a centimetre, so that the mean over many returns is sharper than a graph of noisy matches.
"""

from collections.abc import Sequence

import numpy as np
from pydantic import Field

from executive.arrays import Bool, Float, checked
from executive.config import Meters, Seconds, Settings
from executive.errors import ConfigError, DataError
from executive.geometry.voxels import voxel_means
from executive.interfaces.mapping import Mapper
from executive.messages.cloud import Cloud
from executive.messages.lidar import LidarScan
from executive.messages.motion import Motion
from plugins.mapping.scan_front import ScanFront
from plugins.mapping.voxel_grid import VoxelGrid
from robot_models.machine import Machine

_STRIDE_M = 0.5  # of the machine, before the cylinder follows: less would rebuild the grid for the swing's wobble


class VoxelMapSettings(Settings):
    """Extent and grain of the map."""

    voxel_m: Meters = Field(0.03, gt=0, le=1, description="Edge of a voxel, res_voxel [m].")
    min_points: int = Field(2, ge=1, description="Returns that make a voxel occupied, n_min.")
    radius_m: Meters = Field(10.0, gt=0, description="Radius of the mapped cylinder around the cabin, R_map [m].")
    padding_m: Meters = Field(0.10, ge=0, le=1, description="Returns this near to a link are the machine's [m].")
    nearest_m: Meters = Field(0.6, ge=0, description="Nearer returns are dropped [m].")
    slice_s: Seconds = Field(0.01, gt=0, description="Time over which joints are taken as still [s].")
    smoothing_m: Meters = Field(0.045, ge=0, le=1, description="Reach over which range noise is averaged; 0: none [m].")
    memory: int = Field(100, ge=1, description="Returns over which a voxel's mean is taken.")


class VoxelMap(Mapper):
    """Averages returns of several lidars in a cylinder around the machine; one thread, deterministic."""

    Settings = VoxelMapSettings

    def __init__(self, settings: VoxelMapSettings, machine: Machine) -> None:
        self._settings = settings
        self._machine = machine
        self._front: ScanFront | None = None
        self._grid: VoxelGrid | None = None
        self._cloud: Cloud | None = None
        self._held_radius_m = 0.0
        self._centre_map = np.zeros(3)

    def start(self) -> None:
        """Prepare the shapes and compile the inner loops, so that no scan has to wait for them."""
        s = self._settings
        self._front = ScanFront(self._machine, s.padding_m, s.nearest_m, s.slice_s)
        rehearsal = VoxelGrid(s.voxel_m, s.memory)
        rehearsal.insert(np.zeros((1, 3)))
        rehearsal.keep(np.ones(1, dtype=bool))
        rehearsal.surface(s.voxel_m)
        self._grid = VoxelGrid(s.voxel_m, s.memory)

    def close(self) -> None:
        """Give the map's memory back."""
        self._front = self._grid = self._cloud = None

    def add_scan_pair(self, scans: Sequence[LidarScan], motion: Motion) -> int:
        """Fuse one scan of each lidar; about 15 ms for two of 28,800 returns.

        Raises:
            DataError: If a scan's sensor is no lidar of the machine, or the motion lacks a joint.
        """
        front, grid = self._running()
        parts = [front.place(scan, motion, self._held_radius_m) for scan in scans]
        pair_map = np.vstack([np.empty((0, 3)), *parts])
        self._cloud = None
        self._follow(motion.T_map_cabin[-1][:3, 3], grid)
        grid.insert(pair_map[self._is_in_cylinder(pair_map)])
        return len(pair_map)

    def mask_held(self, radius_m: float) -> None:
        """Drop returns within this distance of the grasp centre, from now on."""
        if radius_m < 0:
            raise DataError(f"the radius around a held stone is {radius_m} m; it must not be negative")
        self._held_radius_m = float(radius_m)

    def remove_sphere(self, centre_map: Float, radius_m: float) -> int:
        """Forget all voxels in a sphere; they stay away until they are seen again."""
        _, grid = self._running()
        centre = checked("centre_map", centre_map, 3)
        points, counts = grid.points()
        kept = ((points - centre) ** 2).sum(axis=1) > radius_m**2
        grid.keep(kept)
        self._cloud = None
        return int((~kept & (counts >= self._settings.min_points)).sum())

    def cloud(self) -> Cloud:
        """Return one point for each occupied voxel in the cylinder, range noise smoothed out.

        The order is that of the voxels. About 100 ms for 300,000 voxels; the answer is kept until the map changes.
        """
        _, grid = self._running()
        if self._cloud is None:
            s = self._settings
            points, counts = grid.surface(s.smoothing_m) if s.smoothing_m else grid.points()
            points = points[(counts >= s.min_points) & self._is_in_cylinder(points)]
            self._cloud = Cloud("map", voxel_means(points, s.voxel_m))
        return self._cloud

    def _follow(self, centre_map: Float, grid: VoxelGrid) -> None:
        """Move the cylinder with the machine, and forget what it leaves behind, now and then."""
        if np.linalg.norm(centre_map - self._centre_map) > _STRIDE_M:
            self._centre_map = centre_map
            grid.keep(self._is_in_cylinder(grid.points()[0]))

    def _is_in_cylinder(self, points_map: Float) -> Bool:
        """Tell which points are near the machine; in height as far as in width."""
        offset = points_map - self._centre_map
        radius_m = self._settings.radius_m
        return np.asarray(((offset[:, :2] ** 2).sum(axis=1) < radius_m**2) & (np.abs(offset[:, 2]) < radius_m))

    def _running(self) -> tuple[ScanFront, VoxelGrid]:
        if self._front is None or self._grid is None:
            raise ConfigError("the map is not started: call `start` before its first use")
        return self._front, self._grid
