"""Check that a cloud can be a site in metres; if not, name the unit that it is probably in."""

from pathlib import Path

import numpy as np

from executive.arrays import Float
from executive.errors import DataError

_WIDEST_M = 500.0  # width of a site, unless its user says that it is wider
_LEAST_M = 0.5  # smallest width of a site: a small stone
_METRES = {"millimetres": 0.001, "centimetres": 0.01, "inches": 0.0254, "feet": 0.3048}
_SURVEYED = ("millimetres", "centimetres")  # units in which a site looks too wide for metres
_SAMPLE = 50_000
_BULK = (1.0, 99.0)  # percentiles between which the bulk of a cloud lies
_NATIONAL_M = 1e5  # larger coordinates are taken to be from a national grid
_STEP_M = 0.03  # the grid of the maps: coordinates in larger steps blur stones
_SAME = 0.15  # largest difference in size of two views of one site, as a share


def check_site(path: Path, points: Float, widest_m: float | None = None) -> None:
    """Refuse a cloud that cannot be a site in metres.

    Args:
        path: The file, for messages.
        points: Its points, shape (N, 3).
        widest_m: Largest width of a site [m]; None for 500 m. Few are wider, and many are in
            centimetres.

    Raises:
        DataError: If the cloud is too wide or too narrow, or its coordinates are too coarse; the
            message names the likely unit.
    """
    most_m = _WIDEST_M if widest_m is None else widest_m
    sample = points[:: 1 + len(points) // _SAMPLE]
    low, high = np.percentile(sample, _BULK, axis=0)
    bulk, whole = float((high - low).max()), float(np.ptp(points, axis=0).max())
    if whole > most_m:
        cure = (
            _crop(points, (low + high) / 2, bulk, most_m)
            if bulk < most_m
            else _rescale(whole, most_m)
        )
        raise DataError(
            f"{path}: {whole:.6g} across is too wide for a site in metres (at most {most_m:g} m); "
            f"{cure}; if it is one, raise that limit (--widest; in missions surveying.max_extent_m)"
        )
    if _is_geographic(sample):
        raise DataError(f"{path}: its x and y look like degrees; project it to metres")
    if whole < _LEAST_M:
        raise DataError(
            f"{path}: {whole:.3g} m across is too small for a site (at least {_LEAST_M:g} m); is "
            "its unit the metre?"
        )
    step = _step_m(sample)
    if step > _STEP_M:
        raise DataError(
            f"{path}: its coordinates come in steps of {step:.2g} m, because single precision or "
            "few digits are too coarse so far from the origin; export it in double precision, or "
            "subtract an offset before"
        )


def unit_hint(source: Float, target: Float) -> str:
    """Return a hint that one of two clouds may be in another unit than the metre, or nothing.

    Use it only after the two have been found not to fit: a cloud may also be small because it shows
    a small part of the site.

    Args:
        source: Points, shape (N, 3).
        target: Points, shape (M, 3).
    """
    ratio = float(np.ptp(source, axis=0).max() / max(np.ptp(target, axis=0).max(), 1e-9))
    for name, one in (("source", ratio), ("target", 1 / max(ratio, 1e-9))):
        for unit, metres in _METRES.items():
            if abs(one * metres - 1) < _SAME:
                return (
                    f"the {name} is {one:.3g} times as large as the other cloud: is it in {unit}?"
                )
    return ""


def _crop(points: Float, centre: Float, bulk: float, most_m: float) -> str:
    far = int((np.abs(points - centre).max(axis=1) > most_m).sum())
    return f"without {far} points far away it is {bulk:.3g} across: crop them"


def _rescale(whole: float, most_m: float) -> str:
    fits = {
        unit: f
        for unit, f in _METRES.items()
        if unit in _SURVEYED and _LEAST_M <= whole * f <= most_m
    }
    cures = [
        f"in {unit} it would be {whole * f:.3g} m: scale it by {f}" for unit, f in fits.items()
    ]
    return ", ".join(cures) or "crop it"


def _is_geographic(sample: Float) -> bool:
    """Return whether x and y can be longitude and latitude [deg].

    They are if they are in the range of such angles and their extent is far below that of z.
    """
    sizes = np.ptp(sample, axis=0)
    in_range = np.abs(sample[:, 0]).max() <= 180 and np.abs(sample[:, 1]).max() <= 90
    return bool(in_range and 0 < sizes[:2].max() < 0.01 and sizes[2] > 20 * sizes[:2].max())


def _step_m(sample: Float) -> float:
    """Return the largest step that all coordinates of one axis are multiples of [m]; 0 if none.

    Only axes with coordinates of a national grid are looked at.
    """
    steps = [0.0]
    for values in sample.T:
        if np.abs(values).max() < _NATIONAL_M:
            continue
        gaps = np.diff(np.unique(values))
        if len(gaps) and np.allclose(gaps / gaps.min(), np.round(gaps / gaps.min()), atol=1e-3):
            steps.append(float(gaps.min()))
    return max(steps)
