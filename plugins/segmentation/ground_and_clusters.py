"""Segmentation by geometry: remove the ground, then cluster what is left into objects."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from executive_plugins.segmentation.cluster_splitting import ClusterSplitter
from executive_plugins.segmentation.clusters import connected_clusters
from executive_plugins.segmentation.convex_splitting import ConvexSplitter
from executive_plugins.segmentation.even_sample import first_in_squares
from executive_plugins.segmentation.feet import feet_of, rows_beside
from executive_plugins.segmentation.ground_plane import fit_ground_plane
from executive_plugins.segmentation.ground_surface import (
    GroundSurface,
    SurfaceFit,
    node_distance_m,
)
from executive_plugins.segmentation.hollow_splitting import HollowSplitter
from executive_plugins.segmentation.limits import Limits, limits_for
from executive_plugins.segmentation.part_kind import Fault, PartJudge, left_out
from executive_plugins.segmentation.plane_splitting import PlaneSplitter
from executive_plugins.segmentation.seam_slivers import SeamSlivers
from executive_plugins.segmentation.seen_ground import SeenGround
from executive_plugins.segmentation.settings import GroundAndClustersSettings
from executive_plugins.segmentation.shape import moments, principal_extents, spans
from executive_plugins.segmentation.site_check import site_warnings, spacing_warnings, unit_warnings
from executive_plugins.segmentation.spacing import spacing_m
from executive_plugins.segmentation.stone_sizes import NO_MACHINE, stone_sizes

from executive.arrays import Float, Int, read_only
from executive.errors import DataError
from executive.geometry.voxels import voxel_means
from executive.interfaces.segmentation import Segmenter
from executive.machine.machine import Machine
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment, Segmentation

_GROUND_SAMPLE = 20_000  # points that shape the ground: 8 in a square metre over ±25 m
_WIDE_SAMPLE = 200_000  # on wider sites: 5 at each node of 100 m × 100 m
_SMALL_SITE_M2 = 2500.0
_A_NODE = 5  # squares with a point, at each node of a site that is wider still


class Splitter(Protocol):
    """Splits a cluster into stones; see `ClusterSplitter`."""

    def count_tops(self, places: Float, heights: Float) -> int: ...
    def split(self, points: Float, places: Float, heights: Float) -> list[Int]: ...


class GroundAndClusters(Segmenter):
    """Ground, Euclidean clusters, planarity check (Mascaro 2020, Sec. 4.3)."""

    Settings = GroundAndClustersSettings
    latency_s = {"segment": 0.1}
    is_stateless = True

    def __init__(self, settings: GroundAndClustersSettings, machine: Machine | None = None) -> None:
        """Take the sizes of stones from the machine where the settings name none."""
        self._settings = settings
        self._sizes = NO_MACHINE if machine is None else stone_sizes(machine)
        rise = float(np.tan(settings.max_rise_rad))
        self._fit = SurfaceFit(settings.node_m, settings.plane_margin_m, rise, settings.stiffness)

    def _splitter(self, limits: Limits) -> Splitter:
        """Return what parts the clusters."""
        s = self._settings
        by_gaps = ClusterSplitter(
            limits.fine_voxel_m,
            limits.cell_m,
            s.valley_depth,
            limits.least_points,
            limits.least_extent_m,
            limits.least_height_m,
            s.core_share,
        )
        by_convexity = self._by_convexity(limits)
        by_planes = PlaneSplitter(limits.patch_m, limits.least_extent_m, by_convexity.is_one)
        slivers = SeamSlivers(limits.patch_m, limits.least_points, by_planes.odds)
        return HollowSplitter(by_gaps, by_planes, by_convexity, slivers)

    def _by_convexity(self, limits: Limits) -> ConvexSplitter:
        return ConvexSplitter(
            limits.patch_m,
            self._settings.concave_rad,
            limits.least_points,
            limits.least_extent_m,
            limits.most_extent_m,
            self._settings.max_hollow,
        )

    def start(self) -> None:
        """Compile the inner loops, so that no cloud has to wait for them."""
        cube = np.mgrid[0:10, 0:10, 0:10].reshape(3, -1).T * 0.05 + [0.0, 0.0, 0.2]
        floor = np.mgrid[0:40, 0:40, 0:1].reshape(3, -1).T * 0.1 - [2.0, 2.0, 0.0]
        self.segment(Cloud("rehearsal", np.vstack([cube, floor])))
        first_in_squares(read_only(floor), 1.0)

    def segment(self, cloud: Cloud) -> Segmentation:
        """Split a cloud into its ground and the objects on it; some 25 ms for 100,000 points.

        Raises:
            DataError: If the cloud has too few points, or no ground.
        """
        settings, rng = self._settings, np.random.default_rng(self._settings.seed)
        if len(cloud) < settings.min_points:
            raise DataError(
                f"a cloud of {len(cloud)} points has no ground to find; at least "
                f"{settings.min_points}: take more of the site, or a denser cloud"
            )
        centre, surface, told_of_site = self._ground(cloud.points, rng)
        plane = surface.plane
        above = surface.heights_above(cloud.points, centre)
        is_rising = above > settings.plane_margin_m
        rising, lying = np.flatnonzero(is_rising), np.flatnonzero(~is_rising)
        points, heights = cloud.points.take(rising, axis=0) - centre, above[rising]
        apart_m = spacing_m(points)
        limits = limits_for(settings, self._sizes, apart_m)
        axes = surface.R_plane_cloud[:2].T
        below = cloud.points.take(lying, axis=0)
        ground = SeenGround(below, centre, axes, limits.patch_m)
        parts, rest, scattered = self._objects(points, heights, points @ axes, limits, ground, rng)
        told = tuple(left_out(*one, centre) for one in rest)
        warnings = (
            *told_of_site,
            *spacing_warnings(apart_m, settings.voxel_m, limits.least_extent_m),
            *unit_warnings(len(parts), told, limits.most_extent_m),
        )
        whole = [part + centre for part in parts]
        between_m = settings.foot_level_m, settings.plane_margin_m
        low = rows_beside(cloud.points, above, between_m, whole, settings.foot_reach_m)
        normals = None if cloud.normals is None else cloud.normals[lying]
        return Segmentation(
            frame=cloud.frame,
            segments=_segments(whole, cloud.points.take(low, axis=0), settings.foot_reach_m),
            ground=Cloud(cloud.frame, below, normals),
            ground_plane=np.array([*plane[:3], plane[3] + plane[:3] @ centre]),
            left_out=told,
            scattered_points=scattered,
            warnings=warnings,
        )

    def _sample(self, points: Float, rng: np.random.Generator) -> Float:
        """Return points that shape the ground: some of all or, where nodes are farther apart than
        asked for, one of each square, as a stone there may have more points than its surroundings.
        """
        sides_m, asked_m = spans(points)[:2], self._settings.node_m
        node_m = node_distance_m(sides_m, asked_m)
        if node_m > asked_m:
            return np.asarray(first_in_squares(points, node_m / float(np.sqrt(_A_NODE))))
        most = _WIDE_SAMPLE if np.prod(sides_m) > _SMALL_SITE_M2 else _GROUND_SAMPLE
        return points[rng.integers(len(points), size=min(len(points), most))]

    def _ground(
        self, points: Float, rng: np.random.Generator
    ) -> tuple[Float, GroundSurface, tuple[str, ...]]:
        """Return a middle of the points [m], the ground about it, and what speaks against a site.

        Far from the origin, as in UTM, products would lose digits.
        """
        s, sample = self._settings, self._sample(points, rng)
        centre = sample.mean(axis=0)
        sample = sample - centre
        plane = fit_ground_plane(sample, s.plane_margin_m, s.max_tilt_rad, rng)
        level = self._fit.level(sample, plane)
        surface = self._fit.on(level)
        heights, relief = surface.heights_above(sample), self._fit.relief(level)
        own = np.random.default_rng(s.seed)
        warnings = site_warnings(sample, plane, heights, relief, s.plane_margin_m, own)
        return centre, surface, warnings

    def merge(self, clouds: Sequence[Cloud]) -> Cloud:
        """Return one point for each occupied cell of `merged_voxel_m`, without normals."""
        frames = sorted({cloud.frame for cloud in clouds})
        if len(frames) != 1:
            raise DataError(
                f"clouds in {len(frames)} frames ({', '.join(frames) or 'no cloud'}) cannot be "
                "merged: express all in one frame first"
            )
        points = np.concatenate([cloud.points for cloud in clouds])
        return Cloud(frames[0], voxel_means(points, self._settings.merged_voxel_m))

    def _objects(
        self,
        points: Float,
        heights: Float,
        places: Float,
        limits: Limits,
        ground: SeenGround,
        rng: np.random.Generator,
    ) -> tuple[list[Float], list[Fault], int]:
        """Part what rises from the ground.

        Returns:
            The point sets that are stones, most points first; those that are not, with the kind and
            the reason; and the number of points in clusters too small.
        """
        s, splitter = self._settings, self._splitter(limits)
        flat = s.flat_margin_m, s.flat_share
        judge = PartJudge(limits, s.max_hollow, *flat, splitter.count_tops, ground)
        labels = connected_clusters(points, np.zeros(len(points), dtype=np.int64), limits.voxel_m)
        order, counts = np.argsort(labels, kind="stable"), np.bincount(labels)
        kept, rest, scattered = list[Float](), list[Fault](), 0
        for members in np.split(order, np.cumsum(counts)[:-1]):
            if len(members) < limits.least_points:
                scattered += len(members)
                continue
            cluster = points.take(members, axis=0)
            where, above = places.take(members, axis=0), heights[members]
            if fault := judge.wide(cluster) or judge.hanging(where, above):
                rest.append((cluster, *fault))
                continue
            split = splitter.split(cluster, where, above)
            parts = [cluster.take(rows, axis=0) for rows in split]
            faults = [
                judge.fault(part, where.take(rows, axis=0), above[rows], rng)
                for part, rows in zip(parts, split, strict=True)
            ]
            if whole := judge.whole(split, faults):
                rest.append((cluster, *whole))
                continue
            for part, fault in zip(parts, faults, strict=True):
                if fault is None:
                    kept.append(part)
                else:
                    rest.append((part, *fault))
        rest.sort(key=lambda one: -len(one[0]))
        return sorted(kept, key=len, reverse=True), rest, scattered


def _segments(parts: Sequence[Float], low: Float, reach_m: float) -> tuple[Segment, ...]:
    """Return the objects with their feet."""
    found = enumerate(zip(parts, feet_of(parts, low, reach_m), strict=True))
    return tuple(
        Segment(number, points, moments(points)[0], principal_extents(points), foot)
        for number, (points, foot) in found
    )
