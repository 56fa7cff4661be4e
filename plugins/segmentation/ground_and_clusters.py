"""Segmentation by geometry: remove the ground, then cluster what is left into objects."""

from collections.abc import Sequence

import numpy as np
from executive_plugins.segmentation.cluster_splitting import ClusterSplitter
from executive_plugins.segmentation.clusters import connected_clusters
from executive_plugins.segmentation.ground_plane import fit_ground_plane
from executive_plugins.segmentation.ground_surface import fit_ground_surface
from executive_plugins.segmentation.settings import GroundAndClustersSettings
from executive_plugins.segmentation.shape import (
    counts_near,
    moments,
    planes_through,
    principal_extents,
    spans,
)
from executive_plugins.segmentation.site_check import site_warnings

from executive.arrays import Float
from executive.errors import DataError
from executive.geometry.voxels import voxel_means
from executive.interfaces.segmentation import Segmenter
from executive.messages.cloud import Cloud
from executive.messages.segment import LeftOut, PartKind, Segment, Segmentation

_GROUND_SAMPLE = 20_000  # points that shape the ground: 50 in a square metre over ±10 m
_WIDEST_HEAP_M = 20.0  # wider clusters are not heaps of stones
Fault = tuple[Float, PartKind, str]  # points of a part that is no stone, what it is, and why


class GroundAndClusters(Segmenter):
    """Ground, Euclidean clusters, planarity check (Mascaro 2020, Sec. 4.3)."""

    Settings = GroundAndClustersSettings
    latency_s = {"segment": 0.1}
    is_stateless = True

    def __init__(self, settings: GroundAndClustersSettings) -> None:
        self._settings = settings
        self._splitter = ClusterSplitter(
            settings.fine_voxel_m,
            settings.cell_m,
            settings.valley_depth,
            settings.min_points,
            settings.min_extent_m,
            settings.min_height_m,
            settings.core_share,
        )

    def start(self) -> None:
        """Compile the inner loops, so that no cloud has to wait for them."""
        cube = np.mgrid[0:10, 0:10, 0:10].reshape(3, -1).T * 0.05 + [0.0, 0.0, 0.2]
        floor = np.mgrid[0:40, 0:40, 0:1].reshape(3, -1).T * 0.1 - [2.0, 2.0, 0.0]
        self.segment(Cloud("rehearsal", np.vstack([cube, floor])))

    def segment(self, cloud: Cloud) -> Segmentation:
        """Split a cloud into its ground and the objects on it; about 15 ms for 100,000 points.

        Raises:
            DataError: If the cloud has too few points, or no ground.
        """
        settings, rng = self._settings, np.random.default_rng(self._settings.seed)
        if len(cloud) < settings.min_points:
            raise DataError(
                f"a cloud of {len(cloud)} points has no ground to find; at least "
                f"{settings.min_points}"
            )
        sample = cloud.points[rng.integers(len(cloud), size=min(len(cloud), _GROUND_SAMPLE))]
        centre = sample.mean(axis=0)  # far from the origin, as in UTM, products would lose digits
        sample = sample - centre
        plane = fit_ground_plane(sample, settings.plane_margin_m, settings.max_tilt_rad, rng)
        surface = fit_ground_surface(
            sample, plane, settings.node_m, settings.relief_m, settings.stiffness
        )
        heights = surface.heights_above(cloud.points, centre)
        is_rising = heights > settings.plane_margin_m
        rising, lying = np.flatnonzero(is_rising), np.flatnonzero(~is_rising)
        points, heights = cloud.points.take(rising, axis=0) - centre, heights[rising]
        parts, rest, scattered = self._objects(
            points, heights, points @ surface.R_plane_cloud[:2].T, rng
        )
        warnings = site_warnings(
            sample,
            plane,
            surface.heights_above(sample),
            settings.plane_margin_m,
            np.random.default_rng(settings.seed),
        )
        normals = None if cloud.normals is None else cloud.normals[lying]
        return Segmentation(
            frame=cloud.frame,
            segments=tuple(_segment(number, part + centre) for number, part in enumerate(parts)),
            ground=Cloud(cloud.frame, cloud.points.take(lying, axis=0), normals),
            ground_plane=np.array([*plane[:3], plane[3] + plane[:3] @ centre]),
            left_out=tuple(_left_out(*one, centre) for one in rest),
            scattered_points=scattered,
            warnings=warnings,
        )

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
        self, points: Float, heights: Float, places: Float, rng: np.random.Generator
    ) -> tuple[list[Float], list[Fault], int]:
        """Part what rises from the ground.

        Returns:
            The point sets that pass size and planarity checks, most points first; those that do
            not, with the kind and the reason; and the number of points in clusters too small.
        """
        labels = connected_clusters(
            points, np.zeros(len(points), dtype=np.int64), self._settings.voxel_m
        )
        order = np.argsort(labels, kind="stable")
        counts = np.bincount(labels)
        kept, rest, scattered = list[Float](), list[Fault](), 0
        for members in np.split(order, np.cumsum(counts)[:-1]):
            if len(members) < self._settings.min_points:
                scattered += len(members)
                continue
            widest_m = float(spans(points[members]).max())
            if widest_m > _WIDEST_HEAP_M:
                reason = f"{widest_m:.1f} m wide, more than any heap ({_WIDEST_HEAP_M:.0f} m)"
                rest.append((points[members], PartKind.STRUCTURE, reason))
                continue
            for rows in self._splitter.split(points[members], places[members], heights[members]):
                part = members[rows]
                fault = self._fault(points[part], places[part], heights[part], rng)
                if fault is None:
                    kept.append(points[part])
                else:
                    rest.append((points[part], *fault))
        rest.sort(key=lambda one: -len(one[0]))
        return sorted(kept, key=len, reverse=True), rest, scattered

    def _fault(
        self, part: Float, places: Float, heights: Float, rng: np.random.Generator
    ) -> tuple[PartKind, str] | None:
        """Return what a part is and why, if it is no stone."""
        s, top_m = self._settings, float(heights.max())
        if top_m < s.min_height_m:
            return PartKind.TOO_SMALL, f"{top_m:.2f} m high, less than {s.min_height_m:.2f} m"
        longest_m = float(principal_extents(part)[0])
        if longest_m < s.min_extent_m:
            return PartKind.TOO_SMALL, f"{longest_m:.2f} m long, less than {s.min_extent_m:.2f} m"
        if longest_m > s.max_extent_m:
            told = f"{longest_m:.2f} m long, more than {s.max_extent_m:.2f} m"
            tops = self._splitter.count_tops(places, heights)
            if tops > 1:
                return PartKind.STACK, f"{told}, with {tops} tops that could not be parted"
            return PartKind.TOO_LARGE, told
        sample = part[rng.integers(len(part), size=min(len(part), 500))]
        planes = planes_through(sample, rng.integers(len(sample), size=(3, 100)))
        if not len(planes):
            return PartKind.UNKNOWN, "its points span no plane"
        flat = int(counts_near(sample, planes, s.flat_margin_m).max()) / len(sample)
        if flat >= s.flat_share:
            return PartKind.STRUCTURE, f"{flat:.0%} of its points are on one plane"
        return None


def _left_out(points: Float, kind: PartKind, reason: str, centre: Float) -> LeftOut:
    mean = moments(points)[0] + centre
    return LeftOut(kind, reason, len(points), mean, principal_extents(points))


def _segment(number: int, points: Float) -> Segment:
    return Segment(number, points, moments(points)[0], principal_extents(points))
