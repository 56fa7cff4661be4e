"""What the newest fixes say of the error of a state whose heading is not known yet."""

from collections import defaultdict, deque

import numpy as np
from executive_plugins.estimation.cholesky import whitened
from executive_plugins.estimation.gate.fix_witness import FixWitness
from executive_plugins.estimation.gate.innovation_bias import BIAS_ROWS
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.gate.stream_period import StreamPeriod

from executive.arrays import Float

# As in a filter whose heading is known: fixes that end a doubt, and the time after which one that
# contradicts nothing is trusted (`reacquire_after_s`).
_HELD, _KEPT_S = 3, 10.0


class AligningWitness:
    """Keeps the innovations of each antenna for a `FixWitness`.

    It outlives the states that are found one after the other: the window of each of them holds the
    fixes of the one before.

    Attributes:
        witness: What the fixes say so far.
    """

    def __init__(self) -> None:
        """Begin without fixes."""
        self._white: dict[str, deque[Float]] = defaultdict(lambda: deque(maxlen=BIAS_ROWS))
        self._periods: dict[str, StreamPeriod] = defaultdict(StreamPeriod)
        self.witness = FixWitness(_HELD, _KEPT_S)

    @property
    def moved2(self) -> Float | None:
        """Second moment of the position's error, see `FixWitness`."""
        return self.witness.moved2

    def take(self, fix: Fix, innovation: Float, covariance: Float) -> None:
        """Take a fix with its innovation [m], shape (3,), and the covariance of that, (3, 3)."""
        period, white = self._periods[fix.antenna], self._white[fix.antenna]
        period.add(fix.stamp_s)
        found = whitened(covariance, innovation)
        if found is not None:
            white.appendleft(found[0])
            self.witness.take(innovation, covariance, np.array(white), period.period_s)

    def use(self, now_s: float) -> None:
        """Take that the state was corrected by the fix that was taken last [s]."""
        self.witness.use(now_s)
