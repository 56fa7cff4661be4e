"""The level about which a measured value sways, while no whole swing of it was seen."""

import numpy as np

from executive.arrays import Float
from executive.machine.stance import SLOWEST_S

# From the stiffest legs under the lightest stone to soft tyres under the heaviest one: 12 t on
# 2 MN/m a leg sway within 0.7 s without a load, and within 1.2 s with 2.6 t at 7 m; a tyre of 0.33
# to 0.65 MN/m makes that twice as long.
PERIODS_S = np.geomspace(0.4, SLOWEST_S, 24)
_DAMPING = (0.0, 0.05, 0.1)  # of critical: steel alone, to legs that stand on soil
_NOISE_SHARE = 0.1  # of the sway that is expected, if there is one; its square is what counts
_FEWEST = 5  # values: one more than level, two amplitudes and noise


def level(times_s: Float, values: Float) -> tuple[float, float]:
    """Estimate the level about which some values sway, if they do.

    The values are at rest, or sway with one of `PERIODS_S` and a damping. Each of these is a linear
    model of unknown noise; the result is the mean of all levels, weighted by how likely the values
    make each model. So the level is known after most of a swing, and at once where nothing sways.

    Args:
        times_s: Times of the values [s], shape (n,).
        values: Values that are as uncertain as each other, shape (n,), one at least.

    Returns:
        The level and its standard deviation, infinite for fewer than five values.

    Source: C. Bishop, Pattern Recognition and Machine Learning, 2006, Sec. 3.5 (evidence of linear
    models); the noise is integrated out with the prior 1/σ.
    """
    middle = float(values.mean())
    off = values - middle
    if len(values) < _FEWEST:
        return middle, float("inf")
    if not off.any():
        return middle, 0.0
    waves = _waves(times_s - times_s[0])
    rest = _fitted(waves[:1, :, :1], np.zeros(1), off)
    sway = _fitted(waves, np.array([0.0, _NOISE_SHARE**2, _NOISE_SHARE**2]), off)
    evidence, levels, variances = np.concatenate([rest, sway], axis=1)
    evidence[1:] += 2 * np.log(_NOISE_SHARE) - np.log(len(waves))  # priors of the models
    share = np.exp(evidence - evidence.max())
    share /= share.sum()
    mean = float(share @ levels)
    return middle + mean, float(np.sqrt(share @ (variances + (levels - mean) ** 2)))


def _waves(since_s: Float) -> Float:
    """Return the base functions of all sways over some times, shape (m, n, 3)."""
    phase = 2 * np.pi * since_s / PERIODS_S[:, None]
    swings = np.stack([np.ones_like(phase), np.cos(phase), np.sin(phase)], axis=2)
    dying = [np.exp(-damping * phase)[:, :, None] ** [0, 1, 1] for damping in _DAMPING]
    return np.concatenate([swings * one for one in dying])


def _fitted(waves: Float, precision: Float, values: Float) -> Float:
    """Fit models, shape (m, n, k), and return their log evidence, levels and variances, (3, m).

    Args:
        waves: Base functions of each model; the first one is constant.
        precision: Of the priors of their factors, over that of the noise, shape (k,).
        values: The values, shape (n,).
    """
    information = waves.transpose(0, 2, 1) @ waves + np.diag(precision)
    inverse, right = np.linalg.inv(information), waves.transpose(0, 2, 1) @ values
    factors = np.einsum("mij,mj->mi", inverse, right)
    squares = values @ values
    left = np.maximum(squares - np.einsum("mi,mi->m", factors, right), 1e-12 * squares)
    evidence = -0.5 * np.linalg.slogdet(information)[1] - 0.5 * (len(values) - 1) * np.log(left)
    return np.stack([evidence, factors[:, 0], left / (len(values) - 1) * inverse[:, 0, 0]])
