"""The bias of a gyroscope as a body at rest shows it, over all that it rested."""

import numpy as np

from executive.arrays import Float


class RestBias:
    """Means of the angular velocity over pieces of rest that do not overlap.

    A body that rests on tyres or soil may rock slowly. This looks like a bias within one piece, and
    shows in how much the pieces differ.

    Attributes:
        rate: Mean of the pieces [rad/s], shape (3,).
        std_rad_s: Standard deviation of a piece, the largest of three axes [rad/s].
    """

    def __init__(self, piece_s: float) -> None:
        """Make one without a piece.

        Args:
            piece_s: Length of a piece [s].
        """
        self._piece_s, self._newest_s = piece_s, -np.inf
        self._means: list[Float] = []
        self._errors: list[float] = []
        self.rate, self.std_rad_s = np.zeros(3), np.inf

    def add(self, stamp_s: float, mean: Float, error_rad_s: float) -> bool:
        """Add the mean rate of a piece that ends now, if the last one ended long enough ago.

        Args:
            stamp_s: End of the piece [s].
            mean: Mean angular velocity [rad/s], shape (3,).
            error_rad_s: Its error by noise, and by its change within the piece [rad/s].

        Returns:
            Whether it was added.
        """
        if stamp_s - self._newest_s < self._piece_s:
            return False
        self._newest_s = stamp_s
        self._means.append(mean)
        self._errors.append(error_rad_s)
        means = np.array(self._means)
        self.rate = means.mean(axis=0)
        spread = means.std(axis=0, ddof=1).max() if len(means) > 1 else 0.0
        self.std_rad_s = max(float(np.sqrt(np.mean(np.square(self._errors)))), float(spread))
        return True
