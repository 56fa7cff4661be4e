"""The machine's motion during a short window, by which a scan is undistorted."""

from dataclasses import dataclass

import numpy as np

from executive.arrays import Float, checked
from executive.errors import DataError
from executive.geometry.pose import interpolate


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """Cabin poses and joint positions over time, newest last.

    Attributes:
        stamps_s: Rising times [s], shape (k,), k ≥ 1.
        T_map_cabin: Estimated cabin poses, shape (k, 4, 4).
        joint_names: n names.
        joint_position: Joint positions [rad] or [m], shape (k, n).
        covariance: Covariance of the newest cabin pose, as in `BaseState`, shape (6, 6); None if it
            is not known.
    """

    stamps_s: Float
    T_map_cabin: Float
    joint_names: tuple[str, ...]
    joint_position: Float
    covariance: Float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "stamps_s", checked("stamps_s", self.stamps_s, None))
        k = len(self.stamps_s)
        object.__setattr__(self, "T_map_cabin", checked("T_map_cabin", self.T_map_cabin, k, 4, 4))
        position = checked("joint_position", self.joint_position, k, len(self.joint_names))
        object.__setattr__(self, "joint_position", position)
        if self.covariance is not None:
            object.__setattr__(self, "covariance", checked("covariance", self.covariance, 6, 6))
        if k == 0 or not (np.diff(self.stamps_s) > 0).all():
            raise DataError("a motion needs at least one sample and rising stamps")

    def _bracket(self, stamp_s: float) -> tuple[int, float]:
        if len(self.stamps_s) == 1 or stamp_s <= self.stamps_s[0]:
            return 0, 0.0
        i = min(int(np.searchsorted(self.stamps_s, stamp_s)) - 1, len(self.stamps_s) - 2)
        fraction = (stamp_s - self.stamps_s[i]) / (self.stamps_s[i + 1] - self.stamps_s[i])
        return i, float(min(fraction, 1.0))

    def T_map_cabin_at(self, stamp_s: float) -> Float:
        """Return the cabin's interpolated pose; outside the window, the pose at its nearer end."""
        i, fraction = self._bracket(stamp_s)
        if fraction == 0.0:
            return np.asarray(self.T_map_cabin[i])
        return interpolate(self.T_map_cabin[i], self.T_map_cabin[i + 1], fraction)

    def joints_at(self, stamp_s: float) -> Float:
        """Return the interpolated joint positions, shape (n,).

        Outside the window, they are those at its nearer end.
        """
        i, fraction = self._bracket(stamp_s)
        if fraction == 0.0:
            return np.asarray(self.joint_position[i])
        return np.asarray(
            (1 - fraction) * self.joint_position[i] + fraction * self.joint_position[i + 1]
        )
