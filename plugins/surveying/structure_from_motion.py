"""Camera poses and sparse points by structure from motion, without a graphics card (pycolmap)."""

import tempfile
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any, Protocol

import numpy as np
from executive_plugins.surveying.photograph_folder import Photographs
from executive_plugins.surveying.settings import MotionSettings
from executive_plugins.surveying.work_folder import WorkFolder

from executive.arrays import Float, Int
from executive.errors import DataError
from executive.extras import require_extra


class Camera(Protocol):
    """What is used of pycolmap's class of the same name, which has no types."""

    width: int
    height: int

    def mean_focal_length(self) -> float:
        """Return the focal length [px]."""

    def img_from_cam(self, points_optical: Float) -> Float:
        """Return the pixels of points, shape (N, 2), with distortion; points have shape (N, 3)."""


@dataclass(frozen=True, slots=True, eq=False)
class PosedPicture:
    """A picture that has found its place.

    Attributes:
        name: Its file.
        camera: Its focal length, principal point and distortion, as pycolmap estimated them [px].
        T_optical_model: Pose of the model in the camera (x right, y down, z forward), shape (4, 4).
        seen: Indices of the sparse points that it shows.
    """

    name: str
    camera: Camera
    T_optical_model: Float
    seen: Int

    @property
    def centre(self) -> Float:
        """Position in the model, shape (3,)."""
        T = self.T_optical_model
        return np.asarray(-T[:3, :3].T @ T[:3, 3])


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """Pictures with places and sparse points (P, 3), in a frame and a scale of their own."""

    pictures: tuple[PosedPicture, ...]
    points: Float


def load_pycolmap() -> ModuleType:
    """Import the package, which takes half a second, and silence its log.

    Raises:
        MissingExtraError: If it is not installed.
    """
    require_extra("structure from motion", "photogrammetry")
    import pycolmap

    pycolmap.logging.minloglevel = pycolmap.logging.FATAL.value
    return pycolmap


def find_motion(
    photographs: Photographs, settings: MotionSettings, seed: int, work: WorkFolder
) -> Model:
    """Match features between near pictures, and reconstruct all from a first pair on (Schönberger
    2016).

    One thread and one seed: equal pictures give an equal model. A model that is in the folder
    already is read from there.

    Raises:
        MissingExtraError: If pycolmap is not installed.
        DataError: If too few pictures find their place; the message says which do not.
    """
    colmap = load_pycolmap()
    links = _links(photographs)
    folder = work.folder("model", lambda part: _solve(colmap, photographs, settings, seed, part))
    largest = colmap.Reconstruction(folder) if any(folder.iterdir()) else None
    placed = _placed(largest) if largest else {}
    names = dict(zip(links, photographs.names, strict=True))
    _check_share(photographs, [names[link] for link in links if link not in placed], settings)
    return _model(largest, names, placed)


def _solve(
    colmap: Any, photographs: Photographs, settings: MotionSettings, seed: int, folder: Path
) -> None:
    """Write the largest model of the pictures to a folder; none if no pair fits."""
    colmap.set_random_seed(seed)
    with tempfile.TemporaryDirectory(prefix="survey_") as scratch:
        work = Path(scratch)
        links = _link(photographs, work / "pictures")
        _extract(colmap, photographs, links, settings, work)
        _match(colmap, photographs, links, settings, seed, work)
        models = colmap.incremental_mapping(
            work / "features.db", work / "pictures", work, _mapping(colmap, seed)
        )
    largest = max(models.values(), key=lambda model: model.num_reg_images(), default=None)
    if largest is not None:
        largest.write(folder)


def _links(photographs: Photographs) -> list[str]:
    return [f"{i:05}{Path(name).suffix.lower()}" for i, name in enumerate(photographs.names)]


def _link(photographs: Photographs, folder: Path) -> list[str]:
    """Give the pictures plain names, in their order: the list of pairs knows no spaces."""
    folder.mkdir()
    links = _links(photographs)
    for name, link in zip(photographs.names, links, strict=True):
        (folder / link).symlink_to((photographs.folder / name).resolve())
    return links


def _extract(
    colmap: Any, photographs: Photographs, links: list[str], settings: MotionSettings, work: Path
) -> None:
    options = colmap.FeatureExtractionOptions()
    options.num_threads, options.use_gpu, options.max_image_size = 1, False, settings.feature_px
    options.sift.max_num_features = settings.features
    options.sift.first_octave = 0  # none finer than a pixel: the picture would be doubled for them
    reader = colmap.ImageReaderOptions()
    if settings.view_angle_rad is not None:
        width, height = photographs.size_px
        focal = width / 2 / np.tan(settings.view_angle_rad / 2)
        reader.camera_params = (
            f"{focal},{width / 2},{height / 2},0"  # f, cx, cy, k: a start for the adjustment
        )
    single, cpu = colmap.CameraMode.SINGLE, colmap.Device.cpu
    colmap.extract_features(
        work / "features.db", work / "pictures", links, single, reader, options, cpu
    )


def _match(
    colmap: Any,
    photographs: Photographs,
    links: list[str],
    settings: MotionSettings,
    seed: int,
    work: Path,
) -> None:
    """Match each picture with those that were taken nearest: of 36, all pairs would be three times
    as many.
    """
    positions = photographs.positions_m
    distances = np.linalg.norm(positions[:, None] - positions, axis=2)
    nearest = np.argsort(distances, axis=1, kind="stable")[:, 1 : settings.neighbours + 1]
    pairs = sorted(
        {(min(i, int(j)), max(i, int(j))) for i in range(len(links)) for j in nearest[i]}
    )
    (work / "pairs.txt").write_text(
        "\n".join(f"{links[i]} {links[j]}" for i, j in pairs), encoding="ascii"
    )
    options, pairing = colmap.FeatureMatchingOptions(), colmap.ImportedPairingOptions()
    options.num_threads, options.use_gpu = 1, False
    pairing.match_list_path = work / "pairs.txt"
    geometry = colmap.TwoViewGeometryOptions()
    geometry.ransac.random_seed = seed
    colmap.match_image_pairs(work / "features.db", options, pairing, geometry, colmap.Device.cpu)


def _mapping(colmap: Any, seed: int) -> Any:
    options = colmap.IncrementalPipelineOptions()
    options.multiple_models, options.extract_colors = False, False
    for part in (options, options.mapper):
        part.num_threads, part.random_seed = 1, seed
    options.triangulation.random_seed = seed
    options.min_model_size = 3
    return options


def _placed(model: Any) -> dict[str, Any]:
    return {image.name: image for image in model.images.values() if image.has_pose}


def _check_share(photographs: Photographs, lost: list[str], settings: MotionSettings) -> None:
    total = len(photographs.names)
    if total - len(lost) < settings.least_registered * total:
        raise DataError(
            f"{photographs.folder}: {total - len(lost)} of {total} pictures found their "
            "place, at least "
            f"{settings.least_registered:.0%} are wanted; lost: "
            f"{', '.join(lost[:5])}{' …' * (len(lost) > 5)}. "
            "Fly with more overlap over ground that is not bare, or raise "
            "surveying.motion.features or .neighbours"
        )


def _model(model: Any, names: dict[str, str], placed: dict[str, Any]) -> Model:
    ids = sorted(model.points3D)
    index = {id_: i for i, id_ in enumerate(ids)}
    pictures = []
    for link in sorted(placed):
        image = placed[link]
        T = np.vstack([image.cam_from_world().matrix(), [0.0, 0.0, 0.0, 1.0]])
        seen = sorted({index[p.point3D_id] for p in image.get_observation_points2D()})
        camera = model.cameras[image.camera_id]
        pictures.append(PosedPicture(names[link], camera, T, np.array(seen, dtype=np.int64)))
    return Model(tuple(pictures), np.array([model.points3D[i].xyz for i in ids]).reshape(-1, 3))
