"""A drone over a simulated site: pictures from about thirty positions, made into a cloud."""

from typing import ClassVar

import numpy as np
from executive_plugins.surveying.flight import take_pictures
from executive_plugins.surveying.reconstruction import own_frame, warp
from executive_plugins.surveying.settings import (
    SimulatedDroneSettings,
)

from executive.arrays import Float
from executive.config import Settings
from executive.errors import DataError
from executive.geometry.voxels import compile_voxel_means, voxel_means
from executive.interfaces.facilities import Scene, SurveyedElsewhere
from executive.interfaces.robot import Robot
from executive.interfaces.surveying import Survey
from executive.messages.cloud import Cloud

FRAME = "survey"
_ABOVE_ALL_M = 90.0  # height above all that stands on a site


class SimulatedDrone(Survey):
    """Surveys a simulated robot's site before the machine drives in: the machine is not in the
    cloud.

    Each picture is a fan of rays, so what no camera sees stays a hole. The paper flew about 200
    pictures for COLMAP (Mascaro 2020, Sec. 4.1); thirty positions cover the site as well, since the
    noise is drawn, not computed. A dozen of them are low, and see stones down to their feet, where
    the jaws close.
    """

    Settings: ClassVar[type[Settings]] = SimulatedDroneSettings
    latency_s: ClassVar[dict[str, float]] = {"survey": 1.0}

    def __init__(self, settings: SimulatedDroneSettings, robot: Robot) -> None:
        self._settings = settings
        self._robot = robot
        self.is_remote = isinstance(robot, SurveyedElsewhere)

    def start(self) -> None:
        """Compile the inner loop where it runs, so that no survey has to wait for it."""
        if not self.is_remote:
            compile_voxel_means()

    def _scene(self) -> Scene:
        if not isinstance(self._robot, Scene):
            raise DataError(
                "surveying: simulated_drone flies over a simulated site, and the robot "
                f"{type(self._robot).__name__} "
                "has none; use point_cloud_file"
            )
        return self._robot

    def survey(self, rng: np.random.Generator) -> Cloud:
        """Fly, reconstruct, and return the cloud in the frame `survey`.

        Raises:
            DataError: If the robot is not a simulated one, or no picture shows any ground.
        """
        if isinstance(self._robot, SurveyedElsewhere):
            return self._robot.survey_of_site(int(rng.integers(2**31)))
        seen = self._seen(rng)
        if not len(seen):
            raise DataError(
                "the drone saw no ground: set surveying.flight.centre_m and size_m to "
                "a place on the site"
            )
        settings = self._settings.reconstruction
        seen = seen + rng.normal(0.0, settings.point_noise_m, seen.shape)
        bent = warp(seen, settings, rng)
        merged = voxel_means(bent, settings.voxel_m, bent.min(axis=0))
        return Cloud(FRAME, own_frame(merged, settings, rng))

    def _top(self, place: Float) -> float:
        """Return the height of the highest surface at a place, 0 where there is none [m]."""
        above, down = np.array([[*place, _ABOVE_ALL_M]]), np.array([[0.0, 0.0, -1.0]])
        top_m = _ABOVE_ALL_M - float(self._scene().cast_rays(above, down)[0])
        return top_m if np.isfinite(top_m) else 0.0

    def _seen(self, rng: np.random.Generator) -> Float:
        """Return what the pictures show of the surveyed ground, with errors of depth, in the map,
        shape (N, 3).
        """
        flight = self._settings.flight
        parts = []
        for picture in take_pictures(flight, self._top, rng):
            ranges = self._scene().cast_rays(
                np.broadcast_to(picture.position, picture.rays.shape), picture.rays
            )
            hit = np.isfinite(ranges)
            noisy = ranges[hit] + rng.normal(
                0.0, self._settings.reconstruction.depth_noise_m, int(hit.sum())
            )
            points = picture.position + noisy[:, None] * picture.rays[hit]
            offset = np.abs(points[:, :2] - flight.centre_m)
            parts.append(points[(offset <= np.array(flight.size_m) / 2).all(axis=1)])
        return np.concatenate(parts)
