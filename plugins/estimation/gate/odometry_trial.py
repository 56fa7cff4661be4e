"""Whether odometry is used: by what separates an estimate that uses it from one that does not."""

from functools import lru_cache
from typing import Protocol

from executive_plugins.estimation.gate.innovation_alarm import FALSE_ALARM_S, binary, usual_size

from executive.geometry import chi_square

_ORDINARY = usual_size(3)
COMPARED = 9  # errors of rotation, velocity and position


class Pair(Protocol):
    """Two estimates that differ by the odometry alone: the one that is reported, and another."""

    @property
    def stamp_s(self) -> float:
        """Their time [s]."""

    def renew_other(self) -> None:
        """Let the second be as the first is."""

    def exchange(self) -> None:
        """Let each be as the other one is."""

    def separation2(self) -> float:
        """Return their squared distance in the larger covariance."""


class OdometryTrial:
    """Keeps one of two estimates free of odometry, and reports it once odometry separates them.

    While fixes hold the state, odometry that is wrong moves the estimate that uses it out of the
    covariance of the other, however it errs. The other is untouched by that error: it is reported
    from then on, and the first begins anew from it. When both have stayed together for long enough,
    the estimate that uses odometry is reported again. Without fixes, nothing but odometry holds the
    state, and it is used. A state that is in doubt, by fixes, decides nothing.

    Attributes:
        trusts: Whether the estimate that is reported uses odometry.
    """

    def __init__(self, pair: Pair, trusted_after_s: float) -> None:
        """Trust odometry at first.

        Args:
            pair: Both estimates.
            trusted_after_s: Time together after which odometry is used again [s].
        """
        self.trusts = True
        self._pair, self._trusted_after_s = pair, trusted_after_s
        self._is_witness = False  # whether the second is free of odometry, or of doubt
        self._since_s, self._is_apart = pair.stamp_s, False

    def dismiss(self) -> None:
        """Let nothing be decided until the second has begun anew."""
        self._is_witness = False

    def trust(self) -> None:
        """Use odometry, as nothing else holds the state."""
        self.trusts, self._is_witness = True, False

    def begin(self) -> None:
        """Begin a comparison if there is none; called while fixes hold the state."""
        if not self._is_witness:
            self._restart()

    def _restart(self) -> None:
        """Let both be the one that is reported."""
        self._pair.renew_other()
        self._is_witness, self._since_s = True, self._pair.stamp_s

    def conclude(self, is_refuted: bool, period_s: float) -> None:
        """Compare both after an increment, and exchange them if that decides who is reported.

        Args:
            is_refuted: Whether odometry is, by its innovations.
            period_s: Usual time between two increments [s].
        """
        pair = self._pair
        limit = separation_limit(binary(period_s))
        self._is_apart = is_refuted or pair.separation2() > limit
        if self._is_apart:
            self._since_s = pair.stamp_s
            if self.trusts:
                self._exchange()
        elif not self.trusts and pair.stamp_s - self._since_s > self._trusted_after_s:
            self._exchange()

    def give_way(self) -> bool:
        """Report the estimate that uses no odometry; return whether the other one was reported."""
        if not (self.trusts and self._is_witness):
            return False
        self._since_s, self._is_apart = self._pair.stamp_s, True
        self._exchange()
        return True

    def _exchange(self) -> None:
        self._pair.exchange()
        self.trusts = not self.trusts

    def takes_fix(self, is_contradicted: bool, other2: float | None) -> bool:
        """Take what a fix says of both; return whether the other one explains it alone.

        A fix that is ordinary for one and contradicts the other tells which of them is
        wrong, be it odometry or the inertial samples that have failed. One that is ordinary for
        none is in doubt itself: then odometry is used, unless it separates both now.

        Args:
            is_contradicted: Whether the fix contradicts the estimate that is reported.
            other2: Squared distance of the fix from the other; None if it contradicts that one.
        """
        if not self._is_witness:
            return False
        is_ordinary = other2 is not None and other2 < _ORDINARY
        if is_contradicted:
            if is_ordinary or not (self.trusts or self._is_apart):
                self._exchange()
            self._since_s = self._pair.stamp_s
            self._restart()
            return is_ordinary
        if other2 is None:
            self._restart()
        return False


@lru_cache(maxsize=64)
def separation_limit(period_s: float) -> float:
    """Return the bound on a squared separation that chance exceeds once in `FALSE_ALARM_S`."""
    return chi_square.bound(period_s / FALSE_ALARM_S, COMPARED)


def drift2(steps: float, drift_m: float) -> float:
    """Return what an increment adds to the variance of the way since the last fix [m²].

    An error b of each increment is k b after k of them, so that the k-th adds (2 k − 1) b².

    Args:
        steps: Number of increments since the last fix, k.
        drift_m: Standard deviation of the error that all increments share [m].
    """
    return (2.0 * max(1.0, steps) - 1.0) * drift_m**2
