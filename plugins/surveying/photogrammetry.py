"""Photogrammetry: from photographs to a cloud, without a graphics card."""

import hashlib
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from executive_plugins.surveying.camera_alignment import CameraAlignment, align_cameras
from executive_plugins.surveying.depth_maps import (
    bands,
    confirmed,
    measure_depth,
    neighbours_of,
    pinhole,
    straightened,
    sweep_planes,
)
from executive_plugins.surveying.fusion import below_flight, cells_of, fuse
from executive_plugins.surveying.photograph_folder import Photographs
from executive_plugins.surveying.plane_sweep import Grey, View
from executive_plugins.surveying.settings import PhotogrammetrySettings
from executive_plugins.surveying.structure_from_motion import Model, PosedPicture, find_motion
from executive_plugins.surveying.work_folder import WorkFolder, work_folder
from numpy.typing import NDArray

from executive.arrays import Float
from executive.errors import DataError
from executive.geometry.pose import pose
from executive.messages.cloud import Cloud

FRAME = "survey"
Tell = Callable[[str], None]
_TOLD = 10  # pictures that are read between two lines of progress


def print_nothing(line: str) -> None:
    """Take no notice of a line of progress."""


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
    photographs: Photographs,
    s: PhotogrammetrySettings,
    rng: np.random.Generator,
    tell: Tell = print_nothing,
    kept: Path | None = None,
) -> Photogrammetry:
    """Find the cameras, their scale, the depth of each picture, and one cloud (Mascaro 2020, Sec.
    4.1).

    Deviation from the paper, which has COLMAP's dense step: that needs a graphics card. Ours sweeps
    planes along the ground through each picture and keeps what others confirm. The number of
    threads changes no bit of the cloud.

    Args:
        photographs: Pictures of one camera.
        s: Settings of each step.
        rng: Chance of the matches and of the scale.
        tell: Is told what is done, a line a step.
        kept: Folder that keeps what is done until the cloud is there: one that was cut off goes on.

    Raises:
        ConfigError: If pycolmap is not installed.
        DataError: If the pictures make no map; the message says why and what to change.
    """
    seed = int(rng.integers(1, 2**31))
    with work_folder(kept, _key(photographs, s, seed)) as work:
        tell(f"{len(photographs.names)} pictures: features, matches and places")
        model = find_motion(photographs, s.motion, seed, work)
        tell(f"{len(model.pictures)} of {len(photographs.names)} pictures in place")
        index = {name: i for i, name in enumerate(photographs.names)}
        positions_m = photographs.positions_m[[index[picture.name] for picture in model.pictures]]
        centres = np.array([picture.centre for picture in model.pictures])
        alignment = align_cameras(centres, positions_m, rng)
        _check_scale(photographs, alignment, s)
        views, depths, neighbours = _depths(photographs, model, alignment, s, (work, tell))
        cameras = np.array([view.centre for view in views])
        points, normals = fuse(_cells(views, depths, neighbours, s, (work, tell)), s.fewest)
    if not len(points):
        raise DataError(
            f"{photographs.folder}: no point is confirmed by {s.depth.confirmed_by} "
            "pictures; overlap more"
        )
    names = tuple(picture.name for picture in model.pictures)
    return Photogrammetry(Cloud(FRAME, points, normals), len(index), alignment, cameras, names)


def _key(photographs: Photographs, s: PhotogrammetrySettings, seed: int) -> str:
    """Return a digest of all that depth maps depend on: pictures, positions, settings, chance."""
    kept = s.model_dump_json(include={"motion", "depth"}, exclude={"depth": {"threads"}})
    digest = hashlib.sha256(f"{kept} {seed} {photographs.size_px}".encode())
    digest.update(photographs.positions_m.tobytes())
    for name in photographs.names:
        state = (photographs.folder / name).stat()
        digest.update(f"{name} {state.st_size} {state.st_mtime_ns}".encode())
    return digest.hexdigest()


def _depths(
    photographs: Photographs, model: Model, alignment: CameraAlignment, s: PhotogrammetrySettings,
    kept: tuple[WorkFolder, Tell],
) -> tuple[list[View], list[Grey], list[list[int]]]:  # fmt: skip
    """Return the views in the survey, their depth maps, and which are neighbours, best first."""
    work, tell = kept
    sparse = alignment.apply(model.points)
    centres = alignment.apply(np.array([picture.centre for picture in model.pictures]))
    planes = sweep_planes(sparse, centres, s.depth)
    focal_px = planes.distance_m / s.depth.pixel_m
    confirming = max(s.depth.compared, s.depth.confirmed_by) + 4
    neighbours = neighbours_of(model.pictures, model.points, s.depth.angle_rad, confirming)
    count = len(model.pictures)

    def view(i: int) -> View:
        picture = model.pictures[i]
        T = _T_optical_survey(picture, alignment)
        K = pinhole(picture.camera, focal_px)[0]
        make = partial(straightened, picture, photographs.folder, focal_px)
        grey = work.array(f"view_{i:05}", make)
        if (i + 1) % _TOLD == 0 or i + 1 == count:
            tell(f"pictures read: {i + 1} of {count}")
        return View(grey, K, T)

    with ThreadPoolExecutor(s.depth.threads) as pool:
        views = list(pool.map(view, range(count)))

    def depth(i: int) -> Grey:
        others = [views[j] for j in neighbours[i]]
        found = work.array(
            f"depth_{i:05}",
            lambda: measure_depth(views[i], others, planes, s.depth).astype(np.float32),
        )
        tell(f"depth of picture {i + 1} of {count}: {len(planes.offsets_m)} planes")
        return found

    with ThreadPoolExecutor(s.depth.threads) as pool:
        return views, list(pool.map(depth, range(count))), neighbours


def _T_optical_survey(picture: PosedPicture, alignment: CameraAlignment) -> Float:
    """Return the survey's pose in a camera, both metric, shape (4, 4)."""
    R = picture.T_optical_model[:3, :3] @ alignment.R.T
    centre = alignment.apply(picture.centre[None])[0]
    return pose(R, -R @ centre)


def _cells(
    views: list[View], depths: list[Grey], neighbours: list[list[int]],
    s: PhotogrammetrySettings, kept: tuple[WorkFolder, Tell],
) -> list[Callable[[], NDArray[np.void]]]:  # fmt: skip
    """Write the cells of each picture into the work folder; return what reads them from there."""
    work, tell = kept
    cameras = np.array([view.centre for view in views])

    def make(i: int) -> NDArray[np.void]:
        points = _believed(i, views, depths, neighbours, cameras, s)
        return cells_of(points, views[i].centre, s.voxel_m)

    def read(i: int) -> NDArray[np.void]:
        return work.array(f"cells_{s.voxel_m}_{s.margin_m}_{i:05}", partial(make, i))

    def write(i: int) -> None:
        read(i)
        if (i + 1) % _TOLD == 0 or i + 1 == len(views):
            tell(f"points of pictures confirmed: {i + 1} of {len(views)}")

    with ThreadPoolExecutor(s.depth.threads) as pool:
        list(pool.map(write, range(len(views))))
    return [partial(read, i) for i in range(len(views))]


def _believed(
    i: int, views: list[View], depths: list[Grey], neighbours: list[list[int]], cameras: Float,
    s: PhotogrammetrySettings,
) -> Float:  # fmt: skip
    """Return the points of one view that others confirm, below the flight."""
    view, depth = views[i], depths[i].astype(np.float64)
    keep = confirmed(view, depth, [(views[j], depths[j]) for j in neighbours[i]], s.depth)

    def points(rows: slice) -> Float:
        seen = view.centre + (view.rays(rows) * depth[rows, :, None])[keep[rows]]
        return seen[below_flight(seen, cameras, s.margin_m)]

    return np.vstack([points(rows) for rows in bands(len(depth))])


def _check_scale(
    photographs: Photographs, alignment: CameraAlignment, s: PhotogrammetrySettings
) -> None:
    if not alignment.scale_error <= s.max_scale_error:  # also not a number
        raise DataError(
            f"{photographs.folder}: the positions are {alignment.residual_m:.2f} m off, "
            "so that the scale is known to "
            f"{alignment.scale_error:.1%} only, allowed is {s.max_scale_error:.1%}; fly "
            "wider, give better positions, "
            "or raise surveying.max_scale_error"
        )
