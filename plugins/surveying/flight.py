"""A drone's flight over the site: the position and the rays of each picture."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from executive_plugins.surveying.settings import FlightSettings

from executive.arrays import Float


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """One view: the camera's position (3,) [m] and unit rays (N, 3), both in the map."""

    position: Float
    rays: Float


def take_pictures(
    settings: FlightSettings, top: Callable[[Float], float], rng: np.random.Generator
) -> list[Picture]:
    """Return the pictures of all rings, with random errors.

    Three in four of `cameras` are from the outer ring, the others from the inner one. The low ring
    keeps its height above what is below it, as its pilot does.

    Args:
        settings: The flight.
        top: Returns the height of the highest surface at a place, shape (2,) [m].
        rng: Source of the errors.
    """
    slanted, steep = settings.cameras - settings.cameras // 4, settings.cameras // 4
    high_m, low_m, around = settings.height_m, settings.low_height_m, settings.low_cameras
    return [
        *_ring(settings, _angles(slanted, rng), 0.65, 0.35, lambda _: 0.0, high_m, rng),
        *_ring(settings, _angles(steep, rng), 0.3, 0.3, lambda _: 0.0, high_m, rng),
        *_ring(settings, _angles(around, rng), 0.65, 0.35, top, low_m, rng),
    ]


def _angles(count: int, rng: np.random.Generator) -> Float:
    """Return where on their ring the pictures are taken [rad], shape (count,)."""
    around = np.arange(count) + rng.uniform(-0.3, 0.3, count)
    return np.asarray(2 * np.pi * around / max(count, 1))


def _ring(
    settings: FlightSettings,
    angles: Float,
    radius: float,
    aim: float,
    below: Callable[[Float], float],
    height_m: float,
    rng: np.random.Generator,
) -> Iterator[Picture]:
    """Yield pictures from an ellipse around the middle of the ground.

    Args:
        settings: The flight.
        angles: Where on the ellipse they are taken [rad], shape (N,).
        radius: Half-axes of the ellipse, as a share of the ground's sides.
        aim: The same of the ellipse that the pictures look at.
        below: Returns the height from which theirs counts, at a place, shape (2,) [m].
        height_m: Their height above it.
        rng: Source of the errors of height and of the rays.
    """
    centre = np.array([*settings.centre_m, 0.0])
    for angle in angles:
        outwards = np.array(
            [np.cos(angle) * settings.size_m[0], np.sin(angle) * settings.size_m[1], 0.0]
        )
        position = centre + radius * outwards
        position[2] = below(position[:2]) + height_m * rng.uniform(0.9, 1.1)
        yield Picture(position, _rays(centre + aim * outwards - position, settings, rng))


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
