"""A map from a pose graph of scan pairs: odometry, scan matching, iSAM2 (Mascaro 2020, 4.2)."""

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import wraps
from typing import Any, TypeVar

import numpy as np
from executive_plugins.mapping.cylinder import Cylinder
from executive_plugins.mapping.density import dense_share
from executive_plugins.mapping.graph_host import GraphHost, InlineGraph, ProcessGraph
from executive_plugins.mapping.held_returns import SLIDE, HeldReturns
from executive_plugins.mapping.map_cloud import MapCloud
from executive_plugins.mapping.node_track import NodeTrack
from executive_plugins.mapping.odometry_noise import OdometryNoise
from executive_plugins.mapping.pair_graph import PairNode
from executive_plugins.mapping.pair_store import PairStore
from executive_plugins.mapping.scan_front_end import ScanFrontEnd
from executive_plugins.mapping.scan_matching import ScanMatcher
from executive_plugins.mapping.scan_pair import ScanPair, assemble
from executive_plugins.mapping.settings import (
    PoseGraphSettings,
)
from executive_plugins.mapping.voxel_grid import VoxelGrid

from executive.arrays import Float, checked
from executive.errors import ConfigError, DataError
from executive.geometry.pose import inverse
from executive.geometry.voxels import compile_voxel_means
from executive.interfaces.mapping import Mapper
from executive.machine.machine import Machine
from executive.messages.cloud import Cloud
from executive.messages.lidar import LidarScan
from executive.messages.motion import Motion
from executive.messages.sector import Sector

_Answer = TypeVar("_Answer")


@dataclass(frozen=True, slots=True, eq=False)
class _LastNode:
    """The newest node, which the next pair is compared with."""

    number: int
    stamp_s: float
    T_map_cabin: Float  # by the state estimate
    covariance: Float | None
    lidars_map: Float


@dataclass(slots=True)
class _Parts:
    """The objects that exist between `start` and `close`."""

    front_end: ScanFrontEnd
    host: GraphHost
    matcher: ScanMatcher
    track: NodeTrack
    store: PairStore
    surface: MapCloud


def _alone(verb: Callable[..., _Answer]) -> Callable[..., _Answer]:
    """Let no two verbs of a map be computed at once."""

    @wraps(verb)
    def waiting(self: "PoseGraph", *args: Any, **kwargs: Any) -> _Answer:
        with self._using:
            return verb(self, *args, **kwargs)

    return waiting


class PoseGraph(Mapper):
    """Matches each pair to the ten before it, and combines the matches with the state estimate.

    Pairs at rest make no node, as in the paper. Deviation from the paper: the first few of them are
    still inserted into the map.

    A thread beside the tick may fuse scan pairs and read the map, one verb at a time.
    """

    Settings = PoseGraphSettings
    beside_tick = ("add_scan_pair", "add_surface", "cloud", "held", "dense_share")

    def __init__(self, settings: PoseGraphSettings, machine: Machine) -> None:
        self._settings = settings
        self._machine = machine
        self._noise = OdometryNoise(settings.odometry)
        self._parts: _Parts | None = None
        self._cylinder = Cylinder(settings.radius_m)
        self._cloud: Cloud | None = None
        self._held_radius_m = 0.0
        self._held = HeldReturns(settings.voxel_m)
        self._last: _LastNode | None = None
        self._pairs_here = 0
        self._anchored_s = -np.inf
        self._using = threading.RLock()  # held by every verb, for as long as it takes

    def start(self) -> None:
        """Prepare the shapes, compile the inner loops, and start the graph's process, if any."""
        s = self._settings
        VoxelGrid.compile()
        compile_voxel_means()  # of what the jaws hold
        MapCloud.compile(s)
        self._parts = _Parts(
            front_end=ScanFrontEnd(self._machine, s),
            host=ProcessGraph(s.window, s.answer_within_s) if s.process else InlineGraph(s.window),
            matcher=ScanMatcher(s.matching),
            track=NodeTrack(2 * s.window),
            store=PairStore(s.voxel_m, s.memory, s.window, 0.5 * s.radius_m),
            surface=MapCloud(s),
        )

    def close(self) -> None:
        """End the process, and release the map's memory."""
        if self._parts is not None:
            self._parts.host.close()
        self._parts = self._cloud = None

    @_alone
    def add_scan_pair(self, scans: Sequence[LidarScan], motion: Motion) -> int:
        """Match a pair, and insert it into the graph and the map.

        Raises:
            DataError: If a scan's sensor is no lidar of the machine, or the motion lacks a joint.
        """
        parts = self._running()
        if self._cylinder.follow(motion.T_map_cabin[-1][:3, 3]):
            parts.store.keep(self._cylinder.contains)
        pair = assemble(parts.front_end, scans, motion, SLIDE * self._held_radius_m, self._cylinder)
        for scan in scans:
            self._held.add(parts.front_end.place_held(scan, motion, self._held_radius_m))
        if pair is None:
            return 0
        self._cloud = None
        self._take_poses(parts)
        lidars_map = parts.front_end.lidars_map(motion, pair.stamp_s)
        if self._has_travelled(lidars_map):
            self._add_node(pair, lidars_map, motion.covariance, parts)
            self._take_poses(parts)
        if self._last is not None and self._pairs_here < self._settings.pairs_at_rest:
            self._pairs_here += 1
            T_node_cabin = inverse(self._last.T_map_cabin) @ pair.T_map_cabin
            T_map_node = parts.track.pose_of(self._last.number)
            parts.store.add(self._last.number, pair.points_cabin, T_node_cabin, T_map_node)
        return pair.kept

    def _has_travelled(self, lidars_map: Float) -> bool:
        if self._last is None:
            return True
        return bool(
            np.linalg.norm(lidars_map - self._last.lidars_map, axis=1).max()
            >= self._settings.travel_m
        )

    def _add_node(
        self, pair: ScanPair, lidars_map: Float, covariance: Float | None, parts: _Parts
    ) -> None:
        number, last = parts.track.next_number, self._last
        since_anchor_s = pair.stamp_s - self._anchored_s
        is_anchor = last is None or self._noise.is_due(since_anchor_s)
        if is_anchor:
            self._anchored_s = pair.stamp_s
        estimate = self._noise.anchor(pair.T_map_cabin, since_anchor_s, covariance)
        if last is None:
            node = PairNode(number, pair.T_map_cabin, estimate, is_anchor)
            parts.track.append(np.eye(4), pair.T_map_cabin)
        else:
            T_before_this = inverse(last.T_map_cabin) @ pair.T_map_cabin
            guess = parts.track.pose_of(last.number) @ T_before_this
            odometry = self._noise.increment(
                T_before_this, pair.stamp_s - last.stamp_s, covariance, last.covariance
            )
            match = parts.matcher.match(pair.points_cabin, guess, parts.track.pose_of)
            node = PairNode(number, guess, estimate, is_anchor, odometry, match)
            parts.track.append(T_before_this, guess)
        parts.host.add(node)
        parts.matcher.add(number, pair.points_cabin)
        self._last = _LastNode(number, pair.stamp_s, pair.T_map_cabin, covariance, lidars_map)
        self._pairs_here = 0

    def _take_poses(self, parts: _Parts) -> None:
        poses = parts.host.take()
        if poses is not None:
            parts.track.take(poses)
            parts.store.move(parts.track.poses())

    @_alone
    def mask_held(self, radius_m: float) -> None:
        """Keep returns within this distance of the grasp centre [m] apart, from now on."""
        if radius_m < 0:
            raise DataError(
                f"the radius around a held stone is {radius_m} m; it must not be negative"
            )
        self._held_radius_m = float(radius_m)
        self._held.clear()

    @_alone
    def held(self) -> Cloud:
        """Return what was seen of the held object since `mask_held`, in the frame `gripper`."""
        return self._held.cloud()

    @_alone
    def remove_sphere(self, centre_map: Float, radius_m: float) -> int:
        """Remove a sphere from the map and from the stored pairs."""
        parts = self._running()
        self._take_poses(parts)
        self._cloud = None
        return parts.store.forget_sphere(
            checked("centre_map", centre_map, 3), radius_m, self._settings.min_points
        )

    @_alone
    def add_surface(self, points_map: Float) -> None:
        """Insert each point as often as is needed for an occupied voxel.

        New returns are averaged with the points.
        """
        parts = self._running()
        points = checked("points_map", points_map, None, 3)
        self._cloud = None
        parts.store.add_surface(
            np.repeat(points[self._cylinder.contains(points)], self._settings.min_points, axis=0)
        )

    def dense_share(self, sector: Sector, points_per_m2: float) -> float:
        """Return the share of the sector's square metres that hold so many points."""
        return dense_share(self.cloud().points, sector, points_per_m2)

    @_alone
    def cloud(self) -> Cloud:
        """Return one point for each occupied voxel: 20 ms for 300,000 voxels after a scan pair.

        The cloud is kept until the map changes.
        """
        parts = self._running()
        self._take_poses(parts)
        if self._cloud is None or parts.store.is_stale:
            self._cloud = parts.surface.cloud(parts.store.grid(), self._cylinder)
        return self._cloud

    def _running(self) -> _Parts:
        if self._parts is None:
            raise ConfigError("the map is not started: call `start` first")
        return self._parts
