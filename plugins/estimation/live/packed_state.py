"""A state of the machine over one row of memory, whose arrays are made on access."""

import numpy as np
from numpy.typing import NDArray

from executive.arrays import Float
from executive.messages.base_state import BaseState

ROW = np.dtype(
    [
        ("stamp_s", "f8"),
        ("T_map_base", "f8", (4, 4)),
        ("T_odom_base", "f8", (4, 4)),
        ("T_map_cabin", "f8", (4, 4)),
        ("v_map_cabin", "f8", (3,)),
        ("w_map_cabin_in_cabin", "f8", (3,)),
        ("covariance", "f8", (6, 6)),
    ],
    align=True,
)


class PackedState(BaseState):
    """A `BaseState` over one row of memory, for an estimator that reports at each inertial sample.

    Making and checking six arrays would take longer than propagating a state. The object can be
    made before the row is written. The caller must ensure that the row, once it is handed out, is
    finite, read-only and not written to any more.
    """

    __slots__ = ("_row",)
    _row: NDArray[np.void]

    def __init__(self, row: NDArray[np.void], status: str) -> None:
        """Make a state of a read-only row, shape (1,), dtype `ROW`."""
        object.__setattr__(self, "_row", row)
        object.__setattr__(self, "status", status)

    def __reduce__(self) -> tuple[object, ...]:
        return BaseState, (*(getattr(self, name) for name in ROW.names or ()), self.status)

    def of_status(self, status: str) -> "PackedState":
        """Return the same state with another status."""
        return PackedState(self._row, status)

    @property
    def stamp_s(self) -> float:
        return float(self._row["stamp_s"][0])

    @property
    def T_map_base(self) -> Float:
        return np.asarray(self._row["T_map_base"][0])

    @property
    def T_odom_base(self) -> Float:
        return np.asarray(self._row["T_odom_base"][0])

    @property
    def T_map_cabin(self) -> Float:
        return np.asarray(self._row["T_map_cabin"][0])

    @property
    def v_map_cabin(self) -> Float:
        return np.asarray(self._row["v_map_cabin"][0])

    @property
    def w_map_cabin_in_cabin(self) -> Float:
        return np.asarray(self._row["w_map_cabin_in_cabin"][0])

    @property
    def covariance(self) -> Float:
        return np.asarray(self._row["covariance"][0])
