"""A pose, or a relative pose, with its covariance."""

from dataclasses import dataclass

import numpy as np

from executive.arrays import Float, checked
from executive.errors import DataError


@dataclass(frozen=True, slots=True, eq=False)
class PoseConstraint:
    """A pose with its covariance.

    Both are checked here, because GTSAM answers a covariance with NaN by the initial values,
    without an error.

    Attributes:
        T: The pose, shape (4, 4).
        covariance: As (rotation [rad], translation [m]) in the frame that T leads from, shape (6,
        6), positive definite.
    """

    T: Float
    covariance: Float

    def __post_init__(self) -> None:
        object.__setattr__(self, "T", checked("T", self.T, 4, 4))
        P = checked("covariance", self.covariance, 6, 6)
        object.__setattr__(self, "covariance", P)
        if np.linalg.eigvalsh(0.5 * (P + P.T))[0] <= 0:
            raise DataError(
                "the covariance of a pose must be positive definite: give each direction a "
                "variance above zero"
            )
