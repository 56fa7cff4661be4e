"""A drone that photographs a simulated site: from pictures to a cloud, as from a real one."""

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import ClassVar

import numpy as np
from executive_plugins.surveying.camera_positions import TABLE
from executive_plugins.surveying.colmap import FEWEST_PICTURES
from executive_plugins.surveying.grid_flight import fly, recorded
from executive_plugins.surveying.photogrammetry import reconstruct
from executive_plugins.surveying.photograph_folder import read_photographs
from executive_plugins.surveying.settings import (
    GridFlightSettings,
    SimulatedPhotographsSettings,
)
from executive_plugins.surveying.structure_from_motion import load_pycolmap
from PIL import Image

from executive.arrays import Float
from executive.config import Settings
from executive.errors import ConfigError
from executive.interfaces.facilities import Photographer, SurveyedElsewhere
from executive.interfaces.robot import Robot
from executive.interfaces.surveying import Survey
from executive.messages.cloud import Cloud

_QUALITY = 92  # of a JPEG: what cameras write
_CAMERA_TAGS, _FOCAL_LENGTH_35MM = 0x8769, 0xA405


class SimulatedPhotographs(Survey):
    """Photographs a simulated robot's site, and surveys it as `colmap` would.

    The cloud comes from the folder alone: pictures, their rough focal length, and positions as a
    drone without corrections records them. Where the camera really was stays with the flight.
    """

    Settings: ClassVar[type[Settings]] = SimulatedPhotographsSettings
    latency_s: ClassVar[dict[str, float]] = {"survey": 1.0}

    def __init__(self, settings: SimulatedPhotographsSettings, robot: Robot) -> None:
        self._settings = settings
        self._robot = robot
        self.is_remote = isinstance(robot, SurveyedElsewhere)

    def start(self) -> None:
        """Check that there is a site to photograph, and what makes a cloud of the pictures.

        Raises:
            ConfigError: If the robot is no simulated one, or pycolmap is not installed.
        """
        if isinstance(self._robot, SurveyedElsewhere):
            return
        load_pycolmap()
        self._photographer()

    def _photographer(self) -> Photographer:
        if not isinstance(self._robot, Photographer):
            raise ConfigError(
                f"surveying: simulated_photographs flies over a simulated site, and the robot "
                f"{type(self._robot).__name__} has none; use colmap with a folder of "
                "photographs, or point_cloud_file"
            )
        return self._robot

    def survey(self, rng: np.random.Generator) -> Cloud:
        """Fly, write the pictures down, and make the folder into a cloud in the frame `survey`.

        Raises:
            ConfigError: If the folder to keep them holds something already.
            DataError: If the pictures make no map; the message says why and what to change.
        """
        if isinstance(self._robot, SurveyedElsewhere):
            return self._robot.survey_of_site(int(rng.integers(2**31)))
        flight_rng, own_rng = rng.spawn(2)
        with _folder(self._settings.folder) as folder:
            take_photographs(self._photographer(), self._settings.flight, folder, flight_rng)
            photographs = read_photographs(folder, None, FEWEST_PICTURES)
            return reconstruct(photographs, self._settings, own_rng).cloud


def take_photographs(
    photographer: Photographer, flight: GridFlightSettings, folder: Path, rng: np.random.Generator
) -> list[Float]:
    """Fly over a site and write what a drone brings home: JPEG files and a table of rough
    positions.

    Returns:
        Where the camera really was, T_world_optical at each picture, for tests.
    """
    poses = fly(flight, rng)
    tags = Image.Exif()
    # The tag is whole millimetres of a film 36 mm wide: rough, as on a real camera.
    tags.get_ifd(_CAMERA_TAGS)[_FOCAL_LENGTH_35MM] = round(18 / np.tan(flight.view_angle_rad / 2))
    names = [f"photograph_{i + 1:03}.jpg" for i in range(len(poses))]
    pictures = photographer.photograph(poses, flight.size_px, flight.view_angle_rad)
    for name, picture in zip(names, pictures, strict=True):
        Image.fromarray(picture).save(folder / name, quality=_QUALITY, exif=tags)
    lines = [
        f"{name},{x:.3f},{y:.3f},{z:.3f}"
        for name, (x, y, z) in zip(names, recorded(poses, flight, rng), strict=True)
    ]
    (folder / TABLE).write_text("\n".join(["name,x,y,z", *lines, ""]), encoding="utf-8")
    return poses


@contextmanager
def _folder(kept: Path | None) -> Iterator[Path]:
    """Give an empty folder: the one to keep, or one that is removed afterwards."""
    if kept is None:
        with tempfile.TemporaryDirectory(prefix="photographs_") as folder:
            yield Path(folder)
        return
    if kept.exists() and (not kept.is_dir() or any(kept.iterdir())):
        raise ConfigError(
            f"surveying.folder: {kept} is there already and not empty; name a new folder"
        )
    kept.mkdir(parents=True, exist_ok=True)
    yield kept
