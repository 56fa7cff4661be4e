"""Compares a position fix with where the estimate puts the antenna at the time of the fix."""

from bisect import bisect_left
from collections.abc import Callable, Sequence

import numpy as np

from executive.arrays import Float
from executive.geometry import chi_square
from executive.geometry.geodesy import enu_from_geodetic
from executive.geometry.rotation import skew
from executive.machine.machine import Machine
from executive.messages.base_state import BaseState
from executive.messages.gnss import GnssFix

# Largest squared Mahalanobis distance: once in 10⁹ fixes of the stated covariances.
_GATE = chi_square.bound(1e-9, 3)


class AntennaCheck:
    """Refuses a fix that the estimate contradicts, before it reaches the estimator.

    A wrong fix that lasts would at last be taken by any estimator, for a filter that refuses all
    fixes must suspect itself. Kept away from it, its own drift widens its covariance instead, and
    with that this gate.

    Args:
        machine: Where the antennas are.
        states: Returns the newest states in order of their stamps.
        datum: Returns the map's origin as geodetic coordinates; None while it is not known.
    """

    def __init__(
        self,
        machine: Machine,
        states: Callable[[], Sequence[BaseState]],
        datum: Callable[[], Float | None],
    ) -> None:
        self._machine, self._states, self._datum = machine, states, datum

    def refusal(self, fix: GnssFix) -> str:
        """Return how far a fix is off, if that is more than both covariances explain."""
        states, datum = self._states(), self._datum()
        antenna = self._machine.sensors.get(fix.antenna)
        if not states or datum is None or antenna is None:
            return ""
        if antenna.link != self._machine.cabin_link:
            return ""
        state = _nearest(states, fix.stamp_s)
        if abs(state.stamp_s - fix.stamp_s) > 2 / antenna.rate_hz:
            return ""  # the estimate does not reach there: nothing to compare with
        p_cabin = antenna.T_link_sensor[:3, 3]
        residual = enu_from_geodetic(fix.geodetic, datum) - _predicted(state, p_cabin, fix.stamp_s)
        covariance = _covariance(state, p_cabin) + fix.covariance_enu_m2
        distance2 = float(residual @ np.linalg.solve(covariance, residual))
        if distance2 <= _GATE:
            return ""
        return f"{np.linalg.norm(residual):.2f} m off the estimate"


def _nearest(states: Sequence[BaseState], stamp_s: float) -> BaseState:
    """Return the state nearest to a stamp; the earlier one of two that are as near."""
    after = bisect_left(states, stamp_s, key=lambda one: one.stamp_s)
    around = states[max(after - 1, 0) : after + 1]
    return min(around, key=lambda one: abs(one.stamp_s - stamp_s))


def _predicted(state: BaseState, p_cabin: Float, stamp_s: float) -> Float:
    R = state.T_map_cabin[:3, :3]
    velocity = state.v_map_cabin + R @ (skew(state.w_map_cabin_in_cabin) @ p_cabin)
    return np.asarray(state.T_map_cabin[:3, 3] + R @ p_cabin + velocity * (stamp_s - state.stamp_s))


def _covariance(state: BaseState, p_cabin: Float) -> Float:
    """Return the covariance of the antenna in map axes [m²], shape (3, 3)."""
    R = state.T_map_cabin[:3, :3]
    J = np.empty((3, 6))
    J[:, :3], J[:, 3:] = -R @ skew(p_cabin), R
    return np.asarray(J @ state.covariance @ J.T)
