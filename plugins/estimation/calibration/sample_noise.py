"""White noise of an inertial sensor from samples of a body that may move."""

import numpy as np
from scipy.special import comb

from executive.arrays import Float

_ORDER = 5  # of the differences: a motion of f Hz at a rate of r Hz leaves (2 π f / r)^5 of itself
_WINDOW = 200  # samples whose motion and vibration are alike


def white_noise(samples: Float) -> tuple[float, float] | None:
    """Return the standard deviation of one sample, and the standard deviation of that figure.

    Differences of high order take a smooth motion away and leave white noise (Gasser et al. 1986,
    "Residual variance and residual pattern in nonlinear regression"; the order is our own). What
    shakes the sensor at rates near its own counts as noise. The median over windows is returned.

    Args:
        samples: Angular velocities or specific forces, evenly sampled, shape (n, 3).

    Returns:
        None if there are fewer than two windows.
    """
    weights = np.array([(-1) ** k * comb(_ORDER, k) for k in range(_ORDER + 1)])
    weights /= np.linalg.norm(weights)
    count = len(samples) // _WINDOW
    if count < 2:
        return None
    variances = []
    for window in np.split(samples[: count * _WINDOW], count):
        left = sum(w * window[k : len(window) - _ORDER + k] for k, w in enumerate(weights))
        variances.append(float(np.mean(np.square(left))))
    stds = np.sqrt(variances)
    # The median of n values errs by 1.25 σ / √n; σ from the quartiles, which outliers do not move.
    spread = float(np.subtract(*np.percentile(stds, [75, 25]))) / 1.349
    return float(np.median(stds)), 1.25 * spread / np.sqrt(count)
