"""A position fix as a filter sees it, with the clock of the receiver."""

from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.state import DIMENSION
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter
from executive_plugins.estimation.kalman.packed_measurements import compare

from executive.arrays import Float


def fix_residual(
    kalman: ErrorStateFilter, fix: Fix, late_s: float
) -> tuple[Float, Float, Float | None, Float]:
    """Compare a fix with the state of a filter.

    A fix whose stamp is late by d was measured at p − v d. The term of second order, a d² / 2, is
    part of the noise.

    Args:
        kalman: The filter, at the stamp of the fix minus `late_s`.
        fix: The fix.
        late_s: What was assumed for d when the fix was queued [s].

    Returns:
        Measured − predicted [m], shape (3,); its derivative by the error of the state, shape
        (3, 15); by that of the clock, shape (3,), None if the clock is known; and the covariance
        of the measurement [m²], shape (3, 3).
    """
    compare(kalman.block, fix.arm_imu, fix.p_map_antenna, fix.covariance, late_s)
    return compared(kalman)


def compared(kalman: ErrorStateFilter) -> tuple[Float, Float, Float | None, Float]:
    """Return the fix that was compared with a filter last, as `fix_residual` does."""
    row = kalman.block[0]
    n = DIMENSION + int(row["companions"])
    H = row["H"][: 3 * n].reshape(3, n)
    by_clock = H[:, DIMENSION].copy() if row["clocks"] else None
    noise = row["noise"][:9].reshape(3, 3).copy()
    return row["residual"][:3].copy(), H[:, :DIMENSION].copy(), by_clock, noise
