"""A drone's flight in strips, for photographs: true and recorded positions."""

import numpy as np
from executive_plugins.surveying.settings import GridFlightSettings

from executive.arrays import Float
from executive.geometry.pose import pose


def fly(settings: GridFlightSettings, rng: np.random.Generator) -> list[Float]:
    """Return the camera's pose at each picture, T_map_optical, with a pilot's unsteadiness."""
    centre = np.array([*settings.centre_m, 0.0])
    poses = []
    for strip, x in enumerate(np.linspace(-0.5, 0.5, settings.strips)):
        along = np.linspace(-0.5, 0.5, settings.pictures)
        for y in along if strip % 2 == 0 else along[::-1]:
            outwards = np.array([x * settings.size_m[0], y * settings.size_m[1], 0.0])
            height = np.array([0.0, 0.0, settings.height_m])
            position = centre + outwards + height + rng.normal(0.0, settings.unsteadiness_m, 3)
            aim = centre + settings.aim * outwards + rng.normal(0.0, settings.unsteadiness_m, 3)
            poses.append(look(position, aim))
    return poses


def recorded(poses: list[Float], settings: GridFlightSettings, rng: np.random.Generator) -> Float:
    """Return the positions that a receiver without corrections records (N, 3) [m].

    The errors of satellites, orbits and air change within minutes, so a short flight has them in
    common; multipath and noise of the receiver are each picture's own.
    """
    positions = np.array([T[:3, 3] for T in poses])
    together = rng.normal(0.0, settings.offset_m, 3)
    return np.asarray(positions + together + rng.normal(0.0, settings.noise_m, positions.shape))


def look(position: Float, aim: Float) -> Float:
    """Return T_map_optical of a camera that looks at a point, its x axis level, shape (4, 4)."""
    forward = (aim - position) / np.linalg.norm(aim - position)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    norm = float(np.linalg.norm(right))
    right = right / norm if norm > 1e-6 else np.array([0.0, -1.0, 0.0])
    return pose(np.stack([right, np.cross(forward, right), forward], axis=1), position)
