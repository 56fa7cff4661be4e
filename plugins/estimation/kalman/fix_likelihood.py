"""How likely a fix is by a packed filter, without the judgement of earlier innovations."""

import math

import numpy as np
from executive_plugins.estimation.cholesky import squared_distance, whitened
from executive_plugins.estimation.direct_call import direct
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.kalman.layout import Block
from executive_plugins.estimation.kalman.packed_measurements import compare

from executive.arrays import Float

_compare = direct(compare)


def scaled_distance2(block: Block, fix: Fix, scale: float, late_s: float) -> float:
    """Compare a filter with a fix, and return the squared distance between both.

    Args:
        block: The filter, shape (1,), dtype `FILTER`, at the time of the fix.
        fix: The fix.
        scale: Factor on its variance.
        late_s: By how much its stamp was thought to be late when it was queued [s].
    """
    _compare(block, fix.arm_imu, fix.p_map_antenna, fix.covariance, late_s)
    block["noise"][0, :9] *= scale
    return squared_distance(innovation_covariance(block), block["residual"][0, :3])


def innovation_covariance(block: Block) -> Float:
    """Return the covariance of the innovation that was compared last, shape (3, 3)."""
    row = block[0]
    S: Float = (row["predicted"][:9] + row["noise"][:9]).reshape(3, 3)
    return S


def log_likelihood(block: Block, noise: Float | None = None) -> float:
    """Return the logarithm of the density of the innovation that was compared last.

    Args:
        block: The filter; a constant that is the same for all is left out.
        noise: Covariance of the fix [m²], shape (9,); None for that of the comparison.

    Returns:
        -inf by a filter whose covariance is not positive definite or not finite any more: one that
        takes an inertial sensor for wrong may diverge until its values overflow.
    """
    row = block[0]
    S = (row["predicted"][:9] + (row["noise"][:9] if noise is None else noise)).reshape(3, 3)
    found = whitened(S, row["residual"][:3])
    if found is None:
        return -math.inf
    _, L, distance2 = found
    return -0.5 * distance2 - float(np.log(np.diag(L)).sum())
