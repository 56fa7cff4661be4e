"""Where a sensor sits on a body of which the log says nothing."""

from collections.abc import Iterable, Mapping

import numpy as np

from executive.arrays import Float
from executive.errors import ConfigError

_MOST_M = 100.0


def read_levers(texts: Iterable[str]) -> Mapping[str, Float]:
    """Read `FRAME:X,Y,Z`: places by frame, in the inertial sensor's axes [m], shape (3,) each.

    Raises:
        ConfigError: If a text has another form, a place is too far, or a frame comes twice.
    """
    levers: dict[str, Float] = {}
    for text in texts:
        frame, _, place = text.rpartition(":")
        try:
            at = np.array([float(one) for one in place.split(",")])
        except ValueError:
            at = np.zeros(0)
        if not frame or at.shape != (3,) or not (np.abs(at) <= _MOST_M).all():
            raise ConfigError(
                f"--lever: '{text}' is not FRAME:X,Y,Z in metres from the inertial sensor, such as "
                "gps:0,0,1.2"
            )
        if frame in levers:
            raise ConfigError(f"--lever: '{frame}' is given twice")
        levers[frame] = at
    return levers
