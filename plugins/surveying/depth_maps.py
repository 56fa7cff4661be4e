"""Depth maps of posed pictures: choice of neighbours, measurement and mutual confirmation."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np
from executive_plugins.surveying.plane_sweep import Grey, View, sweep
from executive_plugins.surveying.settings import DepthSettings
from executive_plugins.surveying.structure_from_motion import PosedPicture
from numba import njit
from PIL import Image
from scipy.ndimage import map_coordinates

from executive.arrays import Bool, Float
from executive.errors import DataError

_PLANES_MOST = 250
_BAND_PX = 256
_STEP_PIXELS = 1.25  # between planes: half a pixel between views 25° apart
_CHANCE = 3  # number of the highest and of the lowest sparse points that may be wrong


@dataclass(frozen=True, slots=True, eq=False)
class SweepPlanes:
    """Planes through the scene, parallel to the ground.

    Attributes:
        normal: Up, unit, shape (3,).
        offsets_m: Of the planes, evenly spaced and rising, shape (P,).
        distance_m: Median distance of the ground from the cameras.
    """

    normal: Float
    offsets_m: Float
    distance_m: float


def sweep_planes(points: Float, centres: Float, settings: DepthSettings) -> SweepPlanes:
    """Fit a plane to sparse points (N, 3), most of which lie on the ground, and span planes along
    it.

    Raises:
        DataError: If there are hardly any points.
    """
    if len(points) < 50:
        raise DataError(
            f"only {len(points)} points were found in several pictures; the ground is "
            "too bare to be seen"
        )
    normal, offset = np.zeros(3), 0.0
    kept = points
    for _ in range(10):
        offset_point = kept.mean(axis=0)
        normal = np.linalg.svd(kept - offset_point, full_matrices=False)[2][2]
        offset = float(normal @ offset_point)
        residuals = np.abs(points @ normal - offset)
        kept = points[residuals <= 2.5 * max(float(np.median(residuals)), 1e-6)]
    if normal @ centres.mean(axis=0) < offset:
        normal, offset = -normal, -offset
    # Stones have few of the points, less than one in a hundred: what is highest counts, but for the
    # very highest.
    heights = np.sort(points @ normal)
    low, high = heights[_CHANCE] - settings.below_m, heights[-1 - _CHANCE] + settings.above_m
    planes = int(
        np.clip(np.ceil((high - low) / (_STEP_PIXELS * settings.pixel_m)) + 1, 8, _PLANES_MOST)
    )
    return SweepPlanes(
        normal, np.linspace(low, high, planes), float(np.median(centres @ normal)) - offset
    )


def make_view(
    picture: PosedPicture, folder: Path, T_optical_survey: Float, focal_px: float
) -> View:
    """Read a picture in grey, without distortion, thinned to a focal length [px].

    Raises:
        DataError: If it is cut short, or lies on its side by a tag that one of two readers follows.
    """
    grey = straightened(picture, folder, focal_px)
    return View(grey, pinhole(picture.camera, focal_px)[0], T_optical_survey)


class Camera(Protocol):
    """What is used of a camera of COLMAP: its size [px] and focal length [px]."""

    width: int
    height: int

    def mean_focal_length(self) -> float:
        """Return the mean of the focal lengths along both axes [px]."""


def pinhole(camera: Camera, focal_px: float) -> tuple[Float, tuple[int, int]]:
    """Return the matrix (3, 3) of a camera thinned to a focal length [px], and width and height."""
    shrink = min(1.0, focal_px / camera.mean_focal_length())
    width, height = round(camera.width * shrink), round(camera.height * shrink)
    focal = camera.mean_focal_length() * width / camera.width
    K = np.array([[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1]])
    return K, (width, height)


def straightened(picture: PosedPicture, folder: Path, focal_px: float) -> Grey:
    """Return the brightness of such a view, shape (height, width).

    Raises:
        DataError: As `make_view`.
    """
    camera = picture.camera
    K, (width, height) = pinhole(camera, focal_px)
    grey = _grey(folder / picture.name, (camera.width, camera.height), (width, height))
    straight = np.empty((height, width), dtype=np.float32)
    for rows in bands(height):
        u, v = np.meshgrid(np.arange(width, dtype=float), np.arange(rows.start, rows.stop))
        rays = np.stack([u, v, np.ones_like(u)], axis=-1).reshape(-1, 3) @ np.linalg.inv(K).T
        # COLMAP counts pixels from the corner of the first, we from its middle.
        x, y = (camera.img_from_cam(rays) * [width / camera.width, height / camera.height] - 0.5).T
        straight[rows] = map_coordinates(grey, np.stack([y, x]), order=1, mode="nearest").reshape(
            -1, width
        )
    return straight


def _grey(path: Path, size_px: tuple[int, int], wanted_px: tuple[int, int]) -> Grey:
    try:
        with Image.open(path) as image:
            if image.size != size_px:
                raise DataError(f"{path}: is turned by its tags; save it upright, without the tag")
            small = image.convert("L").resize(wanted_px, Image.Resampling.BOX)
    except OSError as error:
        raise DataError(
            f"{path}: cannot be read whole ({error}); copy it again, or take it out"
        ) from error
    return np.asarray(small, dtype=np.float32)


def neighbours_of(
    pictures: Sequence[PosedPicture], points: Float, angle_rad: float, count: int
) -> list[list[int]]:
    """Return for each picture those that see most of the same points from an angle that is good for
    depth.

    A shared point counts by how near its angle is to the best one, as a bell whose width is half of
    it: nearer views tell depth badly, farther ones look different.
    """
    is_seen = np.zeros((len(pictures), len(points)), dtype=bool)
    for i, picture in enumerate(pictures):
        is_seen[i, picture.seen] = True
    best = []
    centres = np.array([picture.centre for picture in pictures])
    for i, centre in enumerate(centres):
        rays = _unit(points - centre)
        votes = np.zeros(len(pictures))
        for j in range(len(pictures)):
            shared = is_seen[i] & is_seen[j]
            if j != i and shared.any():
                cosines = (rays[shared] * _unit(points[shared] - centres[j])).sum(axis=1)
                angles = np.arccos(np.clip(cosines, -1, 1))
                votes[j] = np.exp(-0.5 * ((angles - angle_rad) / (angle_rad / 2)) ** 2).sum()
        order = np.argsort(-votes, kind="stable")[:count]
        best.append([int(j) for j in order if votes[j] > 0])
    return best


def _unit(vectors: Float) -> Float:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def measure_depth(
    view: View, others: Sequence[View], planes: SweepPlanes, s: DepthSettings
) -> Float:
    """Return the depth map of a view [m], NaN where the depth is not accepted.

    Args:
        view: The picture.
        others: Its neighbours, best first.
        planes: What is swept.
        s: How many neighbours are compared, and what is accepted.
    """
    if not others:
        return np.full(view.grey.shape, np.nan)
    near = others[: s.compared]
    depth, score = sweep(view, near, planes.normal, planes.offsets_m, s.window_px | 1)
    depth[(score < s.least_score) | (depth > 3 * planes.distance_m)] = np.nan
    return depth


def confirmed(
    view: View, depth: Float, others: Sequence[tuple[View, Float | Grey]], settings: DepthSettings
) -> Bool:
    """Say for each pixel whether enough other depth maps show the same point, shape (h, w)."""
    votes = np.zeros(depth.shape, dtype=np.int64)
    for rows in bands(len(depth)):
        points = view.centre + view.rays(rows) * depth[rows, :, None]
        for other, its_depth in others:
            P = other.K @ other.T_optical_world[:3]
            _vote(points, P, its_depth, settings.tolerance, votes[rows])
    return np.asarray(votes >= settings.confirmed_by)


def bands(height: int) -> Iterator[slice]:
    """Yield rows of a picture, some at a time: arrays of a whole one's rays take a gigabyte."""
    for top in range(0, height, _BAND_PX):
        yield slice(top, min(top + _BAND_PX, height))


@njit(cache=True)
def _vote(points, P, depth, tolerance, votes):  # type: ignore[no-untyped-def]
    """Add one to each point (h, w, 3) that lies where another depth map says, seen through P (3,
    4).
    """
    height, width = depth.shape
    for i in range(points.shape[0]):
        for j in range(points.shape[1]):
            x, y, z = points[i, j]
            if np.isnan(x):
                continue
            w = P[2, 0] * x + P[2, 1] * y + P[2, 2] * z + P[2, 3]
            if w <= 0:
                continue
            u = int(np.floor((P[0, 0] * x + P[0, 1] * y + P[0, 2] * z + P[0, 3]) / w + 0.5))
            v = int(np.floor((P[1, 0] * x + P[1, 1] * y + P[1, 2] * z + P[1, 3]) / w + 0.5))
            if 0 <= u < width and 0 <= v < height and abs(depth[v, u] - w) <= tolerance * w:
                votes[i, j] += 1
