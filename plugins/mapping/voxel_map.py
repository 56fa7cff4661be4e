"""A map of voxels at the poses of the state estimate (Mascaro 2020, Sec. 4.2).

Scans are filtered, undistorted and averaged. Deviation from the paper: there is no scan matching
and no pose graph. The machine is at rest while it works, and its state estimate is accurate to a
centimetre, so that the mean over many returns is sharper than a graph of noisy matches.
"""

import threading
from collections.abc import Mapping, Sequence
from typing import TypedDict, cast

import numpy as np
from executive_plugins.mapping.carving import VOXELS, Carver
from executive_plugins.mapping.cylinder import Cylinder
from executive_plugins.mapping.density import reach_of, share_of
from executive_plugins.mapping.held_returns import SLIDE, HeldReturns
from executive_plugins.mapping.map_cloud import MapCloud
from executive_plugins.mapping.scan_front_end import ScanFrontEnd
from executive_plugins.mapping.settings import VoxelMapSettings
from executive_plugins.mapping.voxel_grid import VoxelGrid

from executive.arrays import Float, Int, checked
from executive.errors import ConfigError, DataError
from executive.geometry.voxels import compile_voxel_means
from executive.interfaces.mapping import Mapper
from executive.machine.machine import Machine
from executive.messages.cloud import Cloud
from executive.messages.lidar import LidarScan
from executive.messages.motion import Motion
from executive.messages.moving_places import MovingPlaces
from executive.messages.sector import Sector

_LAYERS = 3  # of voxels that noise spreads a surface over
_MOST_AT_ONCE = 1_200_000  # voxels for which there is room from the start: 94 MB


class KeptMap(TypedDict):
    """The voxels, the cylinder's centre, and the radius around a held stone."""

    keys: Int
    means: Float
    counts: Int
    centre_map: Float
    held_radius_m: float


class VoxelMap(Mapper):
    """Averages returns of several lidars in a cylinder around the machine; deterministic.

    A thread beside the tick may fuse scan pairs and read the map. It keeps the tick's own verbs
    waiting only while it takes over what has changed.
    """

    Settings = VoxelMapSettings
    beside_tick = ("add_scan_pair", "add_surface", "cloud", "held", "dense_share", "keep")

    def __init__(self, settings: VoxelMapSettings, machine: Machine) -> None:
        self._settings = settings
        self._machine = machine
        self._front_end: ScanFrontEnd | None = None
        self._grid: VoxelGrid | None = None
        self._cloud: Cloud | None = None
        self._surface = MapCloud(settings)
        self._changing = threading.RLock()  # held by what changes the voxels, or copies them
        self._reading = threading.Lock()  # held by what uses the copy
        self._held_radius_m = 0.0
        self._holds = 0  # times that `mask_held` was called
        self._held = HeldReturns(settings.voxel_m)
        self.revision = self._changes = 0
        self._cylinder = Cylinder(settings.radius_m)
        self._carver: Carver | None = None
        self.forgotten = 0

    def start(self) -> None:
        """Prepare the shapes and compile the inner loops, so that no scan waits for them."""
        self._front_end = ScanFrontEnd(self._machine, self._settings)
        VoxelGrid.compile()
        compile_voxel_means()  # of what the jaws hold
        s = self._settings
        MapCloud.compile(s)
        columns = np.pi * (s.radius_m / s.voxel_m) ** 2
        expected = min(round(_LAYERS * columns), _MOST_AT_ONCE)
        self._grid = VoxelGrid(s.voxel_m, s.memory, expected)
        if s.forget_after:
            Carver.compile()
            self._carver = Carver(
                s.voxel_m,
                s.radius_m,
                s.seen_through_m,
                s.forget_after,
                s.smallest_m,
                s.standing_after,
            )

    def close(self) -> None:
        """Release the map's memory."""
        self._front_end = self._grid = self._cloud = self._carver = None
        self._surface = MapCloud(self._settings)

    def keep(self) -> KeptMap:
        """Return the voxels, the cylinder's centre, and the radius around a held stone."""
        _, grid = self._running()
        with self._changing:
            keys, means, counts = grid.rows()
            return {
                "keys": keys,
                "means": means,
                "counts": counts,
                "centre_map": self._cylinder.centre_map,
                "held_radius_m": self._held_radius_m,
            }

    def restore(self, kept: Mapping[str, object]) -> None:
        """Take back the map."""
        own = cast(KeptMap, kept)
        _, grid = self._running()
        grid.refill(own["keys"], own["means"], own["counts"])
        self._cylinder.follow(own["centre_map"])
        self._held_radius_m = own["held_radius_m"]
        self._begin_carving(grid)
        self._changed()

    def add_scan_pair(self, scans: Sequence[LidarScan], motion: Motion) -> int:
        """Fuse one scan of each lidar; about 15 ms for two of 28,800 returns.

        Raises:
            DataError: If a scan's sensor is no lidar of the machine, or the motion lacks a joint.
        """
        front_end, grid = self._running()
        with self._changing:
            radius_m, holds = self._held_radius_m, self._holds
        parts = [front_end.place(scan, motion, SLIDE * radius_m) for scan in scans]
        pair_map = np.vstack([np.empty((0, 3)), *parts])
        held = [front_end.place_held(scan, motion, radius_m) for scan in scans]
        with self._changing:
            if holds == self._holds:  # else they are of what the jaws held before
                for points_gripper in held:
                    self._held.add(points_gripper)
            self._changed()
            if self._cylinder.follow(motion.T_map_cabin[-1][:3, 3]):
                grid.keep(self._cylinder.contains(grid.points()[0]))
                self._begin_carving(grid)
            grid.insert(pair_map[self._cylinder.contains(pair_map)])
            if self._carver is not None:
                views = [
                    (front_end.lidar_map(scan, motion), part)
                    for scan, part in zip(scans, parts, strict=True)
                    if len(part)
                ]
                self.forgotten += grid.erase(self._carver.see(views), VOXELS)
        return len(pair_map)

    def _begin_carving(self, grid: VoxelGrid) -> None:
        if self._carver is not None:
            self._carver.begin(self._cylinder.centre_map, grid.points()[0])

    def mask_held(self, radius_m: float) -> None:
        """Keep returns within this distance of the grasp centre [m] apart, from now on."""
        if radius_m < 0:
            raise DataError(
                f"the radius around a held stone is {radius_m} m; it must not be negative"
            )
        with self._changing:
            self._held_radius_m = float(radius_m)
            self._holds += 1
            self._held.clear()
            self.revision += 1

    def held(self) -> Cloud:
        """Return what was seen of the held object since `mask_held`, in the frame `gripper`."""
        with self._changing:
            returns = self._held.points()
        return self._held.thinned(returns)

    def remove_sphere(self, centre_map: Float, radius_m: float) -> int:
        """Remove all voxels in a sphere, until new returns fill them."""
        _, grid = self._running()
        centre = checked("centre_map", centre_map, 3)
        with self._changing:
            self._changed()
            return grid.forget_sphere(centre, radius_m, self._settings.min_points)

    def add_surface(self, points_map: Float) -> None:
        """Insert each point as often as is needed for an occupied voxel.

        New returns are averaged with the points.
        """
        _, grid = self._running()
        points = checked("points_map", points_map, None, 3)
        with self._changing:
            points = points[self._cylinder.contains(points)]
            self._changed()
            grid.insert(np.repeat(points, self._settings.min_points, axis=0))
            if self._carver is not None:
                self._carver.add(points)

    def dense_share(self, sector: Sector, points_per_m2: float) -> float:
        """Return the share of the sector's square metres that hold so many columns of voxels.

        On ground these are the points of the cloud, without the cost of making it.
        """
        _, grid = self._running()
        with self._reading:
            with self._changing:
                columns = self._surface.current(grid)
            counts = self._surface.counts(columns, sector.centre_map, reach_of(sector))
        return share_of(counts, sector, points_per_m2)

    def cloud(self) -> Cloud:
        """Return one point for each occupied voxel: 30 ms for 450,000 voxels after a scan pair.

        The cloud is kept until the map changes.
        """
        _, grid = self._running()
        with self._reading:
            with self._changing:
                if self._cloud is not None:
                    return self._cloud
                changes, taken = self._changes, self._surface.take(grid, self._cylinder)
            cloud = self._surface.read(*taken)
            with self._changing:
                if changes == self._changes:
                    self._cloud = cloud
            return cloud

    def moving(self) -> MovingPlaces:
        """Return the places that something came into within `standing_after` scan pairs, or that
        the newest pair sees through; none if the map does not forget.
        """
        self._running()
        with self._changing:
            return super().moving() if self._carver is None else self._carver.moving()

    def _changed(self) -> None:
        self._cloud = None
        self._changes += 1
        self.revision += 1

    def _running(self) -> tuple[ScanFrontEnd, VoxelGrid]:
        if self._front_end is None or self._grid is None:
            raise ConfigError("the map is not started: call `start` first")
        return self._front_end, self._grid
