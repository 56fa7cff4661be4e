"""The confidence level of all intervals, and the quantiles that follow from it."""

from scipy import special

CONFIDENCE = 0.95
TAIL = (1.0 - CONFIDENCE) / 2.0  # probability beyond each end
Z = float(special.ndtri(1.0 - TAIL))


def student(degrees_of_freedom: float) -> float:
    """Return the quantile of Student's t that an interval of the level needs."""
    return float(special.stdtrit(degrees_of_freedom, 1.0 - TAIL))
