"""A correction by a fix that tells far more than the state, in steps that are each linear.

Source: the recursive update filter (Zanetti 2012); the noise of a step falls as that of the state.
"""

import numpy as np
from executive_plugins.estimation.direct_call import direct
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.kalman.fix_likelihood import scaled_distance2
from executive_plugins.estimation.kalman.layout import Block
from executive_plugins.estimation.kalman.packed_measurements import correct_by_compared

# Of the variance that the state gives an innovation over the noise of a step: what is left of the
# deviation is half.
_STEP = 3.0
_correct_by_compared = direct(correct_by_compared)


def correct_gradually(block: Block, fix: Fix, scale: float, late_s: float) -> None:
    """Correct by a fix at the time of a state that has been predicted for long.

    Where the position is off by metres and the attitude by some degrees, their product is more than
    the noise of a fix: one linear correction takes it for a measurement of the attitude. Here the
    fix is used in parts, with noise that is divided by the share of each, and each part is linear
    about the state after the one before. For a linear filter this is the same as one correction.

    Args:
        block: The filter, shape (1,), dtype `FILTER`.
        fix, scale, late_s: See `scaled_distance2`.
    """
    left = 1.0
    while left > 0.0:
        scaled_distance2(block, fix, scale, late_s)
        row = block[0]
        predicted, noise = row["predicted"][:9:4], row["noise"][:9:4]  # variances
        share = min(left, _STEP * float(np.min(noise / np.maximum(predicted, 1e-12))))
        row["noise"][:9] /= share
        _correct_by_compared(block, float("inf"))
        left -= share
