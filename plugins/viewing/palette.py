"""Colours by meaning, the same in all views."""

import colorsys

import numpy as np
from numpy.typing import NDArray

GROUND = (150, 140, 125)
DRONE = (120, 170, 220)
MACHINE = (235, 180, 40)
GRASP = (60, 200, 90)
PATH = (230, 60, 150)
SLOT = (90, 90, 230)
STATES = {
    "RUNNING": (240, 180, 40),
    "SUCCESS": (70, 180, 90),
    "FAILURE": (220, 70, 60),
    "INVALID": (110, 110, 110),
    "SKIPPED": (170, 170, 170),
}
ESTIMATES = {  # status of an estimator
    "INITIALISING": (110, 110, 110),
    "GLOBAL": (70, 180, 90),
    "SUSPECT": (240, 180, 40),
    "FALLBACK": (220, 70, 60),
    "RECOVERING": (90, 90, 230),
}

_LOW = np.array([115.0, 100.0, 82.0])  # dark brown
_HIGH = np.array([235.0, 225.0, 205.0])  # light beige
_GOLDEN = 0.6180339887  # golden ratio: consecutive numbers get very different hues


def of_number(number: int) -> tuple[int, int, int]:
    """Return a vivid colour that depends on a number only."""
    r, g, b = colorsys.hsv_to_rgb((0.1 + number * _GOLDEN) % 1.0, 0.75, 0.95)
    return round(255 * r), round(255 * g), round(255 * b)


def of_heights(heights_m: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return earth tones by height, from the 1st to the 99th percentile, shape (N,) → (N, 3)."""
    if not len(heights_m):
        return np.zeros((0, 3), dtype=np.uint8)
    low, high = np.percentile(heights_m, [1, 99])
    share = np.clip((heights_m - low) / max(high - low, 1e-6), 0, 1)[:, None]
    return np.asarray(_LOW + share * (_HIGH - _LOW)).astype(np.uint8)
