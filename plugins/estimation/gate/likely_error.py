"""An error that is likely before it is proven."""

import math

import numpy as np
from executive_plugins.estimation.cholesky import squared_distance

from executive.arrays import Float

# Mean time between two errors that a covariance does not hold, before anything is measured. It is
# shorter than that between two false alarms: those end GLOBAL, and here a covariance grows for some
# seconds.
BEGINS_AFTER_S = 600.0
_NOT_LIKELIER = 0.5  # an error is not likelier than none before anything is measured


def likely_error(apart: Float, covariance: Float, lasts_s: float) -> Float:
    """Return the second moment of an error, over whether there is one, shape (m, m).

    Either the covariance explains what differs, or it is too small by a factor that does: the
    expectation over both (Bayesian model averaging) holds an error before it is proven.

    Args:
        apart: What differs, shape (m,).
        covariance: Of it without an error, shape (m, m).
        lasts_s: Time over which it differs, within which the error would have begun [s].
    """
    count = len(apart)
    squares = squared_distance(covariance, apart) / count
    if not (1.0 < squares < math.inf and lasts_s > 0.0):
        return np.zeros((count, count))
    # The likeliest factor is the mean square of the deviations.
    gain = 0.5 * count * (squares - 1.0 - math.log(squares))
    prior = min(lasts_s / BEGINS_AFTER_S, _NOT_LIKELIER)
    probability = prior / (prior + (1.0 - prior) * math.exp(-gain))
    share = 1.0 - 1.0 / squares  # of what differs, that is the error's
    d = share * apart
    return np.asarray(probability * (np.outer(d, d) + share * covariance))
