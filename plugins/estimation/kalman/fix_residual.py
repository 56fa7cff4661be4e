"""A position fix as a filter sees it, with the clock of the receiver."""

import numpy as np
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.measurement_models import antenna_residual
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter

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
    state = kalman.state
    residual, H = antenna_residual(state, fix.arm_imu, fix.p_map_antenna)
    std_s = kalman.clock_std_s
    if std_s == 0.0:
        return residual, H, None, fix.covariance
    by_clock = -kalman.antenna_shift(fix.arm_imu)
    residual = residual - by_clock * (kalman.clock_s - late_s)
    bend = 0.5 * std_s**2 * kalman.acceleration()
    return residual, H, by_clock, fix.covariance + float(bend @ bend) * np.eye(3)
