"""The scale of a sensor's noise as it was known before an alarm."""

import math

import numpy as np
from numba import njit

from executive.arrays import Float


def calm_scale(kept_s: float, factor: float = 1.0) -> Float:
    """Return the memory of `calm_factor`, shape (3,), without an alarm.

    Args:
        kept_s: How long a scale is kept [s].
        factor: The scale at first.
    """
    return np.array([factor, -math.inf, kept_s])


@njit(cache=True)  # type: ignore[untyped-decorator]
def calm_factor(memory: Float, now_s: float, is_alarmed: bool, newest: float) -> float:
    """Return the factor on the declared variance that is known.

    The scale of before an alarm is kept for some time, so that the alarm does not explain itself:
    a prediction that is wrong makes innovations large, and what is taken for noise grows with
    them. A sensor that has really become noisier is believed after that time.

    Args:
        memory: Of `calm_scale`, shape (3,).
        now_s: The time [s].
        is_alarmed: Whether there is an alarm.
        newest: The factor by the newest innovations.
    """
    factor, calm_s, kept_s = memory[0], memory[1], memory[2]
    if not is_alarmed or now_s - calm_s > kept_s:
        factor = newest
        memory[0] = newest
    if not is_alarmed:
        memory[1] = now_s
    return float(factor)
