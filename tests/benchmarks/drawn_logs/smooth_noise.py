"""Smooth random signals, as sums of sines."""

import numpy as np

from executive.arrays import Float

_SINES = 12


def smooth_noise(rng: np.random.Generator, times_s: Float, std: float, period_s: float) -> Float:
    """Return a signal of mean 0 whose shortest period is about `period_s` [s], shape (N,)."""
    rates = 2 * np.pi / (period_s * rng.uniform(1.0, 8.0, _SINES))
    phases = rng.uniform(0.0, 2 * np.pi, _SINES)
    weights = rng.normal(0.0, std / np.sqrt(_SINES / 2), _SINES)
    signal = np.zeros_like(times_s)
    for rate, phase, weight in zip(rates, phases, weights, strict=True):
        signal += weight * np.sin(rate * times_s + phase)
    return signal


def smooth_step(times_s: Float, from_s: float, over_s: float) -> Float:
    """Return a step from 0 to 1 with continuous acceleration, shape (N,)."""
    u = np.clip((times_s - from_s) / over_s, 0.0, 1.0)
    return np.asarray(u**3 * (10 - 15 * u + 6 * u**2))
