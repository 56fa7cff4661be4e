"""Segmentation by geometry: take the ground away, and what still hangs together is an object."""

import numpy as np
from pydantic import Field

from executive.arrays import Float
from executive.config import Meters, Radians, Settings
from executive.errors import DataError
from executive.interfaces.segmentation import Segmenter
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment, Segmentation
from plugins.segmentation.clusters import connected_clusters
from plugins.segmentation.ground_plane import best_plane, fit_ground_plane, hypothesise_planes
from plugins.segmentation.terrain import fit_terrain

_GROUND_SAMPLE = 20_000  # points that shape the ground: 50 in a square metre over ±10 m


class GroundAndClustersSettings(Settings):
    """How the ground ends and an object begins."""

    plane_margin_m: Meters = Field(0.10, gt=0, le=1, description="Height up to which points are ground, d_plane [m].")
    max_tilt_rad: Radians = Field(np.pi / 6, gt=0, lt=np.pi / 2, description="Ground's largest angle to level [rad].")
    node_m: Meters = Field(1.0, ge=0.2, le=10, description="Distance of the terrain grid's nodes [m].")
    relief_m: Meters = Field(0.30, gt=0, le=2, description="Largest distance of ground from its mean plane [m].")
    stiffness: float = Field(0.2, gt=0, description="Bending of the terrain grid against a cell full of points.")
    voxel_m: Meters = Field(0.07, gt=0, le=1, description="Grid edge of the clustering: smaller gaps join [m].")
    min_points: int = Field(60, ge=10, description="Fewer points are no object.")
    min_extent_m: Meters = Field(0.25, gt=0, description="An object's longest side is at least this [m].")
    max_extent_m: Meters = Field(3.0, gt=0, description="An object's longest side is at most this [m].")
    min_height_m: Meters = Field(0.16, gt=0, description="An object rises at least this far above the ground [m].")
    flat_margin_m: Meters = Field(0.03, gt=0, description="Distance from a plane that still is the plane [m].")
    flat_share: float = Field(0.85, gt=0, le=1, description="Share of points on one plane above which it is no object.")
    seed: int = Field(0, ge=0, description="Seed of the random samples.")


class GroundAndClusters(Segmenter):
    """Ground, Euclidean clusters, planarity check (Mascaro 2020, Sec. 4.3)."""

    Settings = GroundAndClustersSettings
    latency_s = {"segment": 0.1}
    is_stateless = True

    def __init__(self, settings: GroundAndClustersSettings) -> None:
        self._settings = settings

    def start(self) -> None:
        """Compile the inner loop, so that no cloud has to wait for it."""
        fit_terrain(np.eye(3), np.array([0.0, 0.0, 1.0, 0.0]), 1.0, 1.0, 1.0)

    def segment(self, cloud: Cloud) -> Segmentation:
        """Split a cloud into its ground and the objects on it; about 50 ms for 100,000 points.

        Raises:
            DataError: If the cloud has too few points, or no ground.
        """
        settings, rng = self._settings, np.random.default_rng(self._settings.seed)
        if len(cloud) < settings.min_points:
            raise DataError(f"a cloud of {len(cloud)} points has no ground to find; at least {settings.min_points}")
        centre = cloud.points.mean(axis=0)  # far from the origin, as in UTM, products would lose digits
        points = cloud.points - centre
        sample = points[rng.permutation(len(points))[:_GROUND_SAMPLE]]
        plane = fit_ground_plane(sample, settings.plane_margin_m, settings.max_tilt_rad, rng)
        terrain = fit_terrain(sample, plane, settings.node_m, settings.relief_m, settings.stiffness)
        heights = terrain.heights_above(points)
        rising = heights > settings.plane_margin_m
        parts = self._objects(points[rising], heights[rising], rng)
        return Segmentation(
            frame=cloud.frame,
            segments=tuple(_segment(number, part + centre) for number, part in enumerate(parts)),
            ground=Cloud(cloud.frame, cloud.points[~rising], None if cloud.normals is None else cloud.normals[~rising]),
            ground_plane=np.array([*plane[:3], plane[3] + plane[:3] @ centre]),
        )

    def _objects(self, points: Float, heights: Float, rng: np.random.Generator) -> list[Float]:
        """Return the point sets that pass size and planarity checks, most points first."""
        labels = connected_clusters(points, self._settings.voxel_m)
        order = np.argsort(labels, kind="stable")
        counts = np.bincount(labels)
        starts = np.cumsum(counts) - counts
        kept = []
        for start, count in zip(starts, counts, strict=True):
            if count < self._settings.min_points:
                continue
            members = order[start : start + count]
            if heights[members].max() >= self._settings.min_height_m and self._is_object(points[members], rng):
                kept.append(points[members])
        return sorted(kept, key=len, reverse=True)

    def _is_object(self, part: Float, rng: np.random.Generator) -> bool:
        settings = self._settings
        longest = principal_extents(part)[0]
        if not settings.min_extent_m <= longest <= settings.max_extent_m:
            return False
        sample = part[rng.permutation(len(part))[:500]]
        planes = hypothesise_planes(sample, 100, rng)
        return len(planes) > 0 and best_plane(sample, planes, settings.flat_margin_m)[1] < settings.flat_share


def principal_extents(points: Float) -> Float:
    """Return the side lengths of the box along the principal axes, longest first [m], shape (3,)."""
    centred = points - points.mean(axis=0)
    axes = np.linalg.eigh(centred.T @ centred)[1]
    return np.asarray(np.sort(np.ptp(centred @ axes, axis=0))[::-1])


def _segment(number: int, points: Float) -> Segment:
    return Segment(number, points, points.mean(axis=0), principal_extents(points))
