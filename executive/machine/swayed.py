"""What supports that yield make of a moment that changes: the answer of a sway to a motion."""

import numpy as np
from scipy.signal import bilinear, lfilter

from executive.arrays import Float

# Of critical, of legs on soil: the simulated sway loses a tenth to a seventh in half a period.
_DAMPING = 0.04


def swayed(moments: Float, step_s: float, period_s: float) -> Float:
    """Return what presses on the supports while a moment changes, and for a period afterwards.

    A machine on springs is an oscillator. A moment that comes on at once presses by twice as much,
    one that changes its sign after half a period by more than three times as much, and one that
    comes on over a period by hardly more than itself.

    Args:
        moments: The moment over time, from rest, in any unit, shape (m, K).
        step_s: Time between two rows [s].
        period_s: Period of the sway [s]; without one the moment itself presses.

    Returns:
        What presses, in the unit of the moment, shape (m + l, K).
    """
    after = np.zeros((int(np.ceil(period_s / step_s)), moments.shape[1]))
    moved = np.concatenate([moments, after])
    if period_s < 2 * step_s:
        return moved
    turning = 2 * np.pi / period_s
    oscillator = [turning**2], [1.0, 2 * _DAMPING * turning, turning**2]
    return np.asarray(lfilter(*bilinear(*oscillator, fs=1 / step_s), moved, axis=0))
