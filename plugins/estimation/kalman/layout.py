"""Memory layout of a filter: one row, so that a prediction or correction is one compiled call.

A correction of NumPy calls and of objects costs ten times its arithmetic, and between two inertial
samples the processor's caches cool: then it is the amount of code and memory that counts.
"""

import numpy as np
from executive_plugins.estimation.inertial.state import DIMENSION
from executive_plugins.estimation.live.layout import STATE
from numba import from_dtype, njit
from numpy.typing import NDArray

from executive.arrays import Float

COMPANIONS = 7  # the most: a clock, and rotation and position of a clone
_MOST, _ROWS = DIMENSION + COMPANIONS, 6  # errors, and rows of the largest measurement

FILTER = np.dtype(
    [
        # The state, see `InertialState`, and the covariances of its error and its companions'.
        *STATE,
        ("cross", "f8", (DIMENSION, COMPANIONS)),
        ("own", "f8", (COMPANIONS, COMPANIONS)),
        # Companions: clocks come first, then the clone.
        ("clocks", "i8"),
        ("companions", "i8"),
        ("clock_s", "f8"),
        ("holds_clock", "i8"),
        ("clone_R", "f8", (3, 3)),
        ("clone_p", "f8", (3,)),
        # What the samples have shown.
        ("mean_rate", "f8", (3,)),
        ("slow_rate", "f8", (3,)),
        ("gap_s", "f8"),
        ("usual", "f8", (3,)),
        # Deviation of the position by what the fixes err slowly, map axes, see `slow_share`.
        ("slow_m", "f8", (3,)),
        # Constants.
        ("densities", "f8", (4,)),
        ("gravity_m_s2", "f8"),
        # The newest measurement beside its prediction.
        ("residual", "f8", (_ROWS,)),
        ("H", "f8", (_ROWS * _MOST,)),
        ("noise", "f8", (_ROWS * _ROWS,)),
        ("predicted", "f8", (_ROWS * _ROWS,)),
        ("distance2", "f8"),
        # Scratch memory.
        ("P_after", "f8", (DIMENSION, DIMENSION)),
        ("cross_after", "f8", (DIMENSION * COMPANIONS,)),
        ("R_after", "f8", (3, 3)),
        ("vectors_after", "f8", (4, 3)),
        ("turned", "f8", (DIMENSION, DIMENSION)),
        ("joint", "f8", (_MOST * _MOST,)),
        ("moved", "f8", (_MOST * _MOST,)),
        ("after", "f8", (_MOST * _MOST,)),
        ("W", "f8", (_ROWS * (_MOST + 1),)),
        ("L", "f8", (_ROWS * _ROWS,)),
        ("error", "f8", (_MOST,)),
    ],
    align=True,
)
"""A filter with room for its largest companions."""

Block = NDArray[np.void]
FILTER_TYPE = from_dtype(FILTER)[::1]


@njit(cache=True)  # type: ignore[untyped-decorator]
def matrix(memory: Float, rows: int, columns: int) -> Float:
    """Return the beginning of a piece of memory as a matrix, shape (rows, columns)."""
    return memory[: rows * columns].reshape((rows, columns))
