"""Quantiles of the chi-square distribution, to the bit those of `scipy.stats`.

They come from `scipy.special`, because to import `scipy.stats` takes half a second more, for which
each mission would wait.
"""

from scipy.special import chdtri, gammaincinv


def quantile(share: float, degrees: float) -> float:
    """Return the value below which a share of all squared distances lies, between 0 and 1."""
    return float(2 * gammaincinv(degrees / 2, share))


def median(degrees: float) -> float:
    """Return the value below which half of all squared distances lie."""
    return quantile(0.5, degrees)


def bound(share: float, degrees: float) -> float:
    """Return the value above which a share of all squared distances lies, such as 1e-9."""
    return float(chdtri(degrees, share))
