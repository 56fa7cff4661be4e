"""A survey that is read from a point cloud file."""

from typing import ClassVar

import numpy as np
from executive_plugins.surveying.settings import PointCloudFileSettings

from executive.clouds.reader import read_points
from executive.clouds.units import check_site
from executive.config import Settings
from executive.errors import DataError
from executive.geometry.voxels import compile_voxel_means, voxel_means
from executive.interfaces.surveying import Survey
from executive.messages.cloud import Cloud

FRAME = "survey"


class PointCloudFile(Survey):
    """Reads and checks a cloud; its frame is the file's own, shifted towards its middle."""

    Settings: ClassVar[type[Settings]] = PointCloudFileSettings
    latency_s: ClassVar[dict[str, float]] = {"survey": 1.0}
    is_stateless: ClassVar[bool] = True

    def __init__(self, settings: PointCloudFileSettings) -> None:
        self._settings = settings

    def start(self) -> None:
        """Compile the inner loop, so that the survey does not wait for it."""
        compile_voxel_means()

    def survey(self, rng: np.random.Generator) -> Cloud:
        """Return the file's points, merged on a grid, about their middle: surveys often come in
        national coordinates.

        Raises:
            DataError: If the file cannot be read whole, or holds no site; the message names it and
                the cure.
        """
        settings = self._settings
        points = read_points(settings.path)
        if len(points) < settings.min_points:
            raise DataError(
                f"{settings.path}: {len(points)} points, at least {settings.min_points} "
                "are a survey; "
                "export the dense cloud, or lower surveying.min_points"
            )
        check_site(settings.path, points, settings.max_extent_m)
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        points = points - np.round(middle)
        return Cloud(FRAME, voxel_means(points, settings.voxel_m, points.min(axis=0)))
