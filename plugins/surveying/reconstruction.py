"""Simulated errors of structure from motion: noise, a smooth warp, a wrong scale, another frame."""

import numpy as np
from executive_plugins.surveying.settings import ReconstructionSettings

from executive.arrays import Float
from executive.geometry.rotation import about_axis, exp_so3

_WAVES = 3  # of the warp, for each axis


def warp(points: Float, settings: ReconstructionSettings, rng: np.random.Generator) -> Float:
    """Return points (N, 3) [m] bent by slow waves, at most `warp_m` along each axis."""
    bent = points.copy()
    for axis in range(3):
        for _ in range(_WAVES):
            direction = rng.normal(size=3)
            wave = (
                2
                * np.pi
                * direction
                / np.linalg.norm(direction)
                / settings.warp_wavelength_m
                * rng.uniform(0.4, 1)
            )
            bent[:, axis] += (
                settings.warp_m / _WAVES * np.sin(points @ wave + rng.uniform(0, 2 * np.pi))
            )
    return bent


def own_frame(points: Float, settings: ReconstructionSettings, rng: np.random.Generator) -> Float:
    """Return points (N, 3) in a frame of any yaw, some tilt and a scale that is a little off."""
    heading = rng.uniform(0, 2 * np.pi)
    tilt = settings.tilt_rad * rng.uniform() * np.array([np.cos(heading), np.sin(heading), 0.0])
    R = exp_so3(tilt) @ about_axis(np.array([0.0, 0.0, 1.0]), rng.uniform(0, 2 * np.pi))
    scale = 1 + settings.scale_error * rng.uniform(-1, 1)
    return np.asarray(scale * points @ R.T + rng.uniform(-settings.offset_m, settings.offset_m, 3))
