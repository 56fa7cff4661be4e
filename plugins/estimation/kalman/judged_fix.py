"""The correction by a fix, after its innovation was judged by the newest ones of its antenna."""

import numpy as np
from executive_plugins.estimation.gate.innovation_record import (
    DOUBTED,
    INNOVATIONS_TYPE,
    judge,
)
from executive_plugins.estimation.gate.slow_share import follow_slowly
from executive_plugins.estimation.kalman.layout import FILTER_TYPE, Block, matrix
from executive_plugins.estimation.kalman.packed_correction import correct_by
from executive_plugins.estimation.kalman.packed_measurements import compare_fix
from numba import njit, types

from executive.arrays import Float

USED = 4  # a bit of what `use_fix` says, beside those of `judge`
_VECTOR = types.Array(types.float64, 1, "A", readonly=True)
_MATRIX = types.Array(types.float64, 2, "A", readonly=True)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _follow_slow_error(
    s: np.record, before: tuple[float, float, float], share: float, covariance: Float
) -> None:
    """Let the slow error of a fix draw the position along, by as much as the fix has drawn it.

    Args:
        s: The filter, after the correction.
        before: Variances of the position before the correction [m²].
        share: Of the fix's variance that does not scatter.
        covariance: Of the fix [m²], shape (3, 3).
    """
    for i in range(3):
        gain = min(max(1.0 - s.P[6 + i, 6 + i] / before[i], 0.0), 1.0)
        s.slow_m[i] = follow_slowly(s.slow_m[i], gain, share * covariance[i, i])


@njit(  # type: ignore[untyped-decorator]
    types.int64(
        *(FILTER_TYPE, INNOVATIONS_TYPE, _VECTOR, _VECTOR, _MATRIX),
        *(types.float64, types.boolean),
    ),
    cache=True,
)
def use_fix(
    block: Block,
    innovations: Block,
    arm: Float,
    p_map_antenna: Float,
    covariance: Float,
    late_s: float,
    holds_clock: bool,
) -> int:
    """Compare a fix with a filter, judge the innovation, and correct unless it is in doubt.

    Args:
        block: The filter, shape (1,), dtype `FILTER`.
        innovations: The newest ones of the antenna, shape (1,), dtype `INNOVATIONS`.
        arm: The antenna in IMU axes [m], shape (3,).
        p_map_antenna: As measured [m], shape (3,).
        covariance: Of that position [m²], shape (3, 3); what a linear correction leaves out is
            added to it, see `bent_innovation`.
        late_s: By how much its stamp was thought to be late when it was queued [s].
        holds_clock: Whether the clock is left as it is.

    Returns:
        The bits of `judge`, and `USED` if the filter was corrected. A fix in doubt is left to the
        caller, see `correct_by_compared`.
    """
    s = block[0]
    compare_fix(s, arm, p_map_antenna, covariance, late_s)
    predicted, noise = matrix(s.predicted, 3, 3), matrix(s.noise, 3, 3)
    said = int(judge(innovations[0], s.residual[:3], predicted, noise, s.sample.stamp_s))
    if said & DOUBTED:
        return said
    s.holds_clock = int(holds_clock)
    x, y, z = s.P[6, 6], s.P[7, 7], s.P[8, 8]
    if not correct_by(s, 3, innovations[0].gate):
        return said
    _follow_slow_error(s, (x, y, z), innovations[0].slow_share, covariance)
    return said | USED
