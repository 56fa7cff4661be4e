"""A drone's flight in strips, for photographs: true and recorded positions."""

import numpy as np
from pydantic import Field

from executive.arrays import Float
from executive.config import Meters, Radians, Settings
from executive.geometry.pose import pose


class GridFlightSettings(Settings):
    """Strips to and fro over the site; pictures look inwards, so that those from the outside see
    the stones' sides.
    """

    strips: int = Field(4, ge=2, le=50, description="Number of strips, along y.")
    pictures: int = Field(9, ge=2, le=100, description="Pictures of each strip.")
    centre_m: tuple[float, float] = Field(
        (3.7, 0.0), description="Middle of the surveyed ground in the map [m]."
    )
    size_m: tuple[float, float] = Field(
        (10.0, 18.0), description="Sides of the flight along x and y [m]."
    )
    aim: float = Field(
        0.5, ge=0, le=1, description="Pictures look so far out as a share of how far out they are."
    )
    height_m: Meters = Field(
        8.0, gt=1, le=100, description="Height of the flight above the map's origin [m]."
    )
    unsteadiness_m: Meters = Field(
        0.2, ge=0, le=5, description="Deviation from the plan, of place and aim [m]."
    )
    size_px: tuple[int, int] = Field(
        (1000, 750), description="Width and height of the pictures [px]."
    )
    view_angle_rad: Radians = Field(
        1.2, gt=0.2, lt=2.5, description="Opening angle across the width [rad]."
    )
    offset_m: Meters = Field(
        1.5, ge=0, le=50, description="Error of all recorded positions together [m]."
    )
    noise_m: Meters = Field(0.5, ge=0, le=20, description="Error of each, along each axis [m].")


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
