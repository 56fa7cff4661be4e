"""Directions that cover the sphere evenly."""

import numpy as np

from executive.arrays import Float

_GOLDEN_RAD = np.pi * (3.0 - np.sqrt(5.0))


def even_directions(count: int) -> Float:
    """Return unit vectors on a Fibonacci spiral from pole to pole, shape (count, 3)."""
    z = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    turn, radius = _GOLDEN_RAD * np.arange(count), np.sqrt(1.0 - z**2)
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn), z])
