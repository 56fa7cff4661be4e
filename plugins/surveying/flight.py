"""A drone's flight over the site: the position and the rays of each picture."""

from dataclasses import dataclass

import numpy as np
from executive_plugins.surveying.settings import FlightSettings

from executive.arrays import Float


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """One view: the camera's position (3,) [m] and unit rays (N, 3), both in the map."""

    position: Float
    rays: Float


def take_pictures(settings: FlightSettings, rng: np.random.Generator) -> list[Picture]:
    """Return the pictures of both rings, three in four from the outer one, with random errors."""
    slanted = settings.cameras - settings.cameras // 4
    return [
        *_ring(settings, slanted, 0.65, 0.35, rng),
        *_ring(settings, settings.cameras // 4, 0.3, 0.3, rng),
    ]


def _ring(
    settings: FlightSettings, count: int, radius: float, aim: float, rng: np.random.Generator
) -> list[Picture]:
    """Return pictures from an ellipse around the middle of the ground.

    Args:
        settings: The flight.
        count: Number of pictures.
        radius: Half-axes of the ellipse, as a share of the ground's sides.
        aim: The same of the ellipse that the pictures look at.
        rng: Source of the errors of angle and height.
    """
    pictures = []
    for angle in 2 * np.pi * (np.arange(count) + rng.uniform(-0.3, 0.3, count)) / max(count, 1):
        outwards = np.array(
            [np.cos(angle) * settings.size_m[0], np.sin(angle) * settings.size_m[1], 0.0]
        )
        centre = np.array([*settings.centre_m, 0.0])
        position = (
            centre + radius * outwards + [0.0, 0.0, settings.height_m * rng.uniform(0.9, 1.1)]
        )
        pictures.append(Picture(position, _rays(centre + aim * outwards - position, settings, rng)))
    return pictures


def _rays(forward: Float, settings: FlightSettings, rng: np.random.Generator) -> Float:
    """Return the rays of a square picture around a viewing direction, jittered within their pixels,
    shape (N, 3).
    """
    forward = forward / np.linalg.norm(forward)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right = (
        right / np.linalg.norm(right) if np.linalg.norm(right) > 1e-6 else np.array([1.0, 0.0, 0.0])
    )
    down = np.cross(forward, right)
    n = settings.rays
    pixels = (
        np.stack(np.meshgrid(np.arange(n), np.arange(n)), axis=-1) + rng.random((n, n, 2))
    ) / n - 0.5
    across = 2 * np.tan(settings.view_angle_rad / 2) * pixels.reshape(-1, 2)
    rays = forward + across[:, :1] * right + across[:, 1:] * down
    return np.asarray(rays / np.linalg.norm(rays, axis=1, keepdims=True))
