"""Releases under noise that are spread evenly over what the noise can do, the farthest first."""

import numpy as np

from executive.arrays import Float
from executive.geometry.rotation import exp_so3

_GOLDEN_RAD = np.pi * (3 - np.sqrt(5))  # successive headings that never fall together


def releases(
    T_map_stone: Float, count: int, noise_m: float, noise_rad: float, rng: np.random.Generator
) -> list[Float]:
    """Return poses (4, 4) around one, off by normal noise along x and y and about all axes.

    The distances are the middles of `count` equally likely parts of their distribution (Rayleigh),
    so that a few releases stand for all. Of eight that were drawn freely with 3 cm, one in five
    sets had one that was off by more than 8 cm before it was let go, and said of the place that
    the stone slides away. The farthest comes first: a place that does not hold is refused soon.

    Args:
        T_map_stone: The pose in the middle, shape (4, 4).
        count: Number of poses.
        noise_m: Standard deviation along x and along y [m].
        noise_rad: Standard deviation about each axis [rad].
        rng: Draws the headings and the rotations.
    """
    first_rad, found = rng.uniform(0.0, 2 * np.pi), []
    for number in range(count):
        distance_m = noise_m * np.sqrt(-2.0 * np.log((number + 0.5) / count))
        heading = first_rad + number * _GOLDEN_RAD
        T = np.array(T_map_stone)
        T[:2, 3] += distance_m * np.array([np.cos(heading), np.sin(heading)])
        T[:3, :3] = exp_so3(rng.normal(0.0, noise_rad, 3)) @ T[:3, :3]
        found.append(T)
    return found
