"""What can be wrong with satellite fixes: each a function of time and antenna to the error in the
map, or no fix.
"""

from collections.abc import Callable

import numpy as np

from executive.arrays import Float

Fault = Callable[
    [float, str], Float | None
]  # (stamp [s], antenna) → error [m], shape (3,); None: no fix


def none(stamp_s: float, antenna: str) -> Float | None:
    """Leave each fix as it is."""
    return np.zeros(3)


def wander(rng: np.random.Generator, std_m: float) -> Fault:
    """Let all fixes drift slowly together, as the atmosphere and reflections make real ones do; no
    covariance tells it.
    """
    periods_s = rng.uniform((10.0, 20.0, 40.0), (20.0, 40.0, 80.0))
    phases = rng.uniform(0, 2 * np.pi, (3, 3))
    size_m = std_m * np.sqrt(2 / 3)
    return lambda stamp_s, antenna: (
        size_m * np.sin(2 * np.pi * stamp_s / periods_s[:, None] + phases).sum(axis=0)
    )


def spikes(rng: np.random.Generator, starts_s: tuple[float, ...]) -> Fault:
    """Move fixes by 3 to 4 m for 0.05 to 1 s, of one antenna or of both; their covariance stays
    good.
    """
    drawn = [
        (s, s + rng.uniform(0.05, 1.0), _direction(rng) * rng.uniform(3, 4), rng.integers(3))
        for s in starts_s
    ]

    def fault(stamp_s: float, antenna: str) -> Float | None:
        for start_s, end_s, error, which in drawn:
            if start_s <= stamp_s < end_s and (
                which == 2 or antenna.endswith(("left", "right")[which])
            ):
                return np.asarray(error)
        return np.zeros(3)

    return fault


def plateau(rng: np.random.Generator, size_m: float, from_s: float, to_s: float) -> Fault:
    """Move all fixes by the same offset for some time."""
    error = size_m * _direction(rng, level=True)
    return lambda stamp_s, antenna: error if from_s <= stamp_s < to_s else np.zeros(3)


def ramp(rng: np.random.Generator, speed_m_s: float, size_m: float, from_s: float) -> Fault:
    """Let all fixes drift away to a given offset, then return at once."""
    direction, to_s = _direction(rng, level=True), from_s + size_m / speed_m_s
    return lambda stamp_s, antenna: (
        direction * speed_m_s * (stamp_s - from_s) * (from_s <= stamp_s < to_s)
    )


def outage(from_s: float, to_s: float) -> Fault:
    """Give no fix for some time."""
    return lambda stamp_s, antenna: None if from_s < stamp_s < to_s else np.zeros(3)


def _direction(rng: np.random.Generator, level: bool = False) -> Float:
    v = rng.normal(0, 1, 3) * (1.0, 1.0, 0.0 if level else 1.0)
    return np.asarray(v / np.linalg.norm(v))
