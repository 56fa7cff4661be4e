"""Photogrammetry: from photographs to a cloud, without a graphics card."""

from dataclasses import dataclass

import numpy as np
from executive_plugins.surveying.camera_alignment import CameraAlignment, align_cameras
from executive_plugins.surveying.depth_maps import (
    confirmed,
    make_view,
    measure_depth,
    neighbours_of,
    sweep_planes,
)
from executive_plugins.surveying.fusion import below_flight, fuse
from executive_plugins.surveying.photograph_folder import Photographs
from executive_plugins.surveying.plane_sweep import View
from executive_plugins.surveying.settings import (
    PhotogrammetrySettings,
)
from executive_plugins.surveying.structure_from_motion import Model, PosedPicture, find_motion

from executive.arrays import Float
from executive.errors import DataError
from executive.geometry.pose import pose
from executive.messages.cloud import Cloud

FRAME = "survey"


@dataclass(frozen=True, slots=True, eq=False)
class Photogrammetry:
    """A cloud, and how it was made.

    Attributes:
        cloud: In the frame `survey`: metric, z up, about the mean of the rough positions.
        pictures: Number given.
        alignment: From the model to the survey; its positions are those of the pictures that found
            their place.
        centres_m: Of the cameras that found their place, in the survey, shape (N, 3).
        names: Of those pictures.
    """

    cloud: Cloud
    pictures: int
    alignment: CameraAlignment
    centres_m: Float
    names: tuple[str, ...]


def reconstruct(
    photographs: Photographs, s: PhotogrammetrySettings, rng: np.random.Generator
) -> Photogrammetry:
    """Find the cameras, their scale, the depth of each picture, and one cloud (Mascaro 2020, Sec.
    4.1).

    Deviation from the paper, which has COLMAP's dense step: that needs a graphics card. Ours sweeps
    planes along the ground through each picture and keeps what others confirm.

    Raises:
        ConfigError: If pycolmap is not installed.
        DataError: If the pictures make no map; the message says why and what to change.
    """
    model = find_motion(photographs, s.motion, int(rng.integers(1, 2**31)))
    index = {name: i for i, name in enumerate(photographs.names)}
    positions_m = photographs.positions_m[[index[picture.name] for picture in model.pictures]]
    centres = np.array([picture.centre for picture in model.pictures])
    alignment = align_cameras(centres, positions_m, rng)
    _check_scale(photographs, alignment, s)
    views, depths, neighbours = _depths(photographs, model, alignment, s)
    cameras = np.array([view.centre for view in views])
    parts = (_believed(i, views, depths, neighbours, cameras, s) for i in range(len(views)))
    points, normals = fuse(parts, s.voxel_m, s.fewest)
    if not len(points):
        raise DataError(
            f"{photographs.folder}: no point is confirmed by {s.depth.confirmed_by} "
            "pictures; overlap more"
        )
    names = tuple(picture.name for picture in model.pictures)
    return Photogrammetry(Cloud(FRAME, points, normals), len(index), alignment, cameras, names)


def _depths(
    photographs: Photographs, model: Model, alignment: CameraAlignment, s: PhotogrammetrySettings
) -> tuple[list[View], list[Float], list[list[int]]]:
    """Return the views in the survey, their depth maps, and which are neighbours, best first."""
    sparse = alignment.apply(model.points)
    centres = alignment.apply(np.array([picture.centre for picture in model.pictures]))
    planes = sweep_planes(sparse, centres, s.depth)
    focal_px = planes.distance_m / s.depth.pixel_m
    views = [
        make_view(picture, photographs.folder, _T_optical_survey(picture, alignment), focal_px)
        for picture in model.pictures
    ]
    confirming = max(s.depth.compared, s.depth.confirmed_by) + 4
    neighbours = neighbours_of(model.pictures, model.points, s.depth.angle_rad, confirming)
    return views, measure_depth(views, neighbours, planes, s.depth), neighbours


def _T_optical_survey(picture: PosedPicture, alignment: CameraAlignment) -> Float:
    """Return the survey's pose in a camera, both metric, shape (4, 4)."""
    R = picture.T_optical_model[:3, :3] @ alignment.R.T
    centre = alignment.apply(picture.centre[None])[0]
    return pose(R, -R @ centre)


def _believed(
    i: int, views: list[View], depths: list[Float], neighbours: list[list[int]], cameras: Float,
    s: PhotogrammetrySettings,
) -> tuple[Float, Float]:  # fmt: skip
    """Return the points of one view that others confirm, below the flight, and its camera."""
    view, depth = views[i], depths[i]
    keep = confirmed(view, depth, [(views[j], depths[j]) for j in neighbours[i]], s.depth)
    points = view.centre + (view.rays() * depth[..., None])[keep]
    return points[below_flight(points, cameras, s.margin_m)], view.centre


def _check_scale(
    photographs: Photographs, alignment: CameraAlignment, s: PhotogrammetrySettings
) -> None:
    if not alignment.scale > 0 or alignment.scale_error > s.max_scale_error:
        raise DataError(
            f"{photographs.folder}: the positions are {alignment.residual_m:.2f} m off, "
            "so that the scale is known to "
            f"{alignment.scale_error:.1%} only, allowed is {s.max_scale_error:.1%}; fly "
            "wider, give better positions, "
            "or raise surveying.max_scale_error"
        )
