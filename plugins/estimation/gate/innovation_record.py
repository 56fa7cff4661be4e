"""What the newest innovations of one antenna show, in one row of memory."""

import math

import numpy as np
from executive_plugins.estimation.cholesky import whiten
from executive_plugins.estimation.gate.calm_scale import calm_factor, calm_scale
from executive_plugins.estimation.gate.innovation_alarm import (
    WINDOW,
    alarm_limit,
    alert,
    binary,
    usual_size,
)
from executive_plugins.estimation.gate.innovation_bias import (
    BIAS_ROWS,
    Lean,
    bias_limit,
    lean_of,
    look_for_lean,
)
from executive_plugins.estimation.gate.innovation_scale import (
    SCALE_COUNT,
    know_scale,
    median_size,
    middle_factor,
    rescale,
)
from executive_plugins.estimation.gate.slow_share import (
    PAIRS,
    WINDOWS,
    quiet_limits,
    slow_share,
    usual_sums,
)
from numba import from_dtype, njit
from numpy.typing import NDArray

from executive.arrays import Float

DOUBTED, LEANS = 1, 2  # what `judge` says, as bits
INNOVATIONS = np.dtype(
    [
        ("alarm_rows", "f8", (WINDOW, 3)),
        ("alarm_counts", "i8", (3,)),
        ("bias_rows", "f8", (BIAS_ROWS, 3)),
        ("bias_counts", "i8", (2,)),
        ("bias_end", "f8", (3,)),
        ("factors", "f8", (SCALE_COUNT,)),
        ("factor_counts", "i8", (2,)),
        ("middle", "f8"),  # of the factors
        ("calm", "f8", (3,)),
        ("pair_sums", "f8", (PAIRS,)),
        ("pair_counts", "i8", (2,)),
        ("pair_before", "f8", (3,)),
        ("slow_share", "f8"),
        # Bounds.
        ("gate", "f8"),
        ("alarm_limit", "f8"),
        ("bias_limit", "f8"),
        ("usual", "f8"),
        ("median", "f8"),
        ("quiet_limits", "f8", (len(WINDOWS),)),
        ("usual_sums", "f8", (len(WINDOWS),)),
        # Scratch memory: the newest innovation's covariance, its factor, and what it whitens.
        ("S", "f8", (3, 3)),
        ("root", "f8", (3, 3)),
        ("white", "f8", (3,)),
    ],
    align=True,
)
INNOVATIONS_TYPE = from_dtype(INNOVATIONS)[::1]


class InnovationRecord:
    """Alarm, bias and scale of one antenna's innovations, judged in one compiled call."""

    def __init__(
        self,
        gate: float,
        kept_s: float,
        factor: float,
        block: NDArray[np.void] | None = None,
    ) -> None:
        """Make one without innovations.

        Args:
            gate: Largest squared Mahalanobis distance of a fix.
            kept_s: How long the scale of before an alarm is kept [s].
            factor: Factor on the declared variance until there are enough innovations.
            block: A row of zeros to be used, shape (1,), dtype `INNOVATIONS`.
        """
        self.block: NDArray[np.void] = np.zeros(1, INNOVATIONS) if block is None else block
        self._period_s = 0.0
        row = self.block[0]
        row["gate"], row["usual"], row["median"] = gate, usual_size(3), median_size(3)
        row["usual_sums"] = usual_sums(3)
        row["calm"] = calm_scale(kept_s, factor)
        know_scale(row["factors"], row["factor_counts"], factor)
        row["middle"] = middle_factor(row["factors"], row["factor_counts"])

    def expect(self, period_s: float) -> None:
        """Set the usual time between two innovations [s]: false alarms are as rare in time."""
        if period_s == self._period_s:
            return
        self._period_s, row, usual_s = period_s, self.block[0], binary(period_s)
        row["alarm_limit"], row["bias_limit"] = alarm_limit(3, usual_s), bias_limit(3, usual_s)
        row["quiet_limits"] = quiet_limits(3, usual_s)

    def renew(self) -> None:
        """Forget all innovations: they were of another state. The scale of before is kept."""
        row = self.block[0]
        for counts in ("alarm_counts", "bias_counts", "pair_counts"):
            row[counts] = 0
        row["slow_share"] = 0.0
        know_scale(row["factors"], row["factor_counts"], self.known_scale)
        row["middle"] = middle_factor(row["factors"], row["factor_counts"])

    @property
    def known_scale(self) -> float:
        """Factor on the declared variance as it was known before an alarm."""
        return float(self.block[0]["calm"][0])

    def clear_bias(self) -> None:
        """Forget by what innovations lean: it is part of the prediction now."""
        self.block["bias_counts"] = 0

    @property
    def is_alarmed(self) -> bool:
        """Whether the newest innovations are larger than chance allows."""
        return bool(self.block[0]["alarm_counts"][2])

    @property
    def is_biased(self) -> bool:
        """Whether the newest innovations lean to one side."""
        return bool(self.block[0]["bias_counts"][1])

    @property
    def covariance(self) -> Float:
        """Covariance of the newest innovation by what was known before it [m²], shape (3, 3)."""
        return np.array(self.block[0]["S"])

    @property
    def white(self) -> Float:
        """The newest innovations but outliers in standard deviations, newest first, (n, 3)."""
        row = self.block[0]
        return np.asarray(row["bias_rows"][: row["bias_counts"][0]])

    @property
    def lean(self) -> Lean | None:
        """What the newest innovations show; None if they do not lean."""
        row = self.block[0]
        return lean_of(row["bias_counts"], row["root"], row["bias_end"])


@njit(cache=True)  # type: ignore[untyped-decorator]
def judge(g: np.record, residual: Float, predicted: Float, noise: Float, now_s: float) -> int:
    """Take an innovation, and scale its noise by the factor that the newest ones explain.

    If they show that the prediction is wrong instead, the fix errs as was known before.

    Args:
        g: The row, dtype `INNOVATIONS`.
        residual: Measured minus predicted, shape (3,).
        predicted: Covariance of the prediction, shape (3, 3).
        noise: Covariance that is declared, and result, shape (3, 3).
        now_s: Time of the innovation [s].

    Returns:
        `DOUBTED` if fix and prediction contradict each other, and `LEANS` if a bias explains that.
    """
    factor = calm_factor(g.calm, now_s, g.alarm_counts[2] != 0, g.middle)
    for i in range(3):
        for j in range(3):
            g.S[i, j] = predicted[i, j] + factor * noise[i, j]
    distance2 = whiten(g.S, residual, g.root, g.white)
    if math.isfinite(distance2):
        bounds = g.gate, g.alarm_limit, g.usual
        alert(g.alarm_rows[:], g.alarm_counts[:], g.white, distance2, *bounds)
        g.slow_share = slow_share(
            *(g.pair_sums[:], g.pair_counts[:], g.pair_before[:], g.white),
            *(g.quiet_limits[:], g.usual_sums[:]),
        )
    is_near = distance2 <= g.gate  # outliers say nothing of the prediction
    if is_near:
        look_for_lean(g.bias_rows[:], g.bias_counts[:], g.white, g.bias_limit, g.bias_end[:])
    leans = is_near and g.bias_counts[1] != 0
    if not leans:
        rescale(g.factors[:], g.factor_counts[:], residual, predicted, noise, g.median)
        factor = g.middle = middle_factor(g.factors[:], g.factor_counts[:])
    for i in range(3):
        for j in range(3):
            noise[i, j] *= factor
    is_doubted = not is_near or g.alarm_counts[2] != 0 or g.bias_counts[1] != 0
    return (DOUBTED if is_doubted else 0) | (LEANS if leans else 0)
