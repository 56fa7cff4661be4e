"""States against the truth of a drawn log: start, error, and what their covariance promised."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from drawn_logs.motion import Motion
from executive.arrays import Float
from executive.messages.base_state import BaseState

_PERIOD_S = 0.1  # between two judged states


@dataclass(frozen=True, slots=True, eq=False)
class Verdict:
    """What came of one estimator on one log.

    Attributes:
        started_s: Time of the first state [s]; inf if there was none.
        stamps_s: Times of the judged states [s], shape (N,).
        error_m: Distance from the true position [m], shape (N,).
        error_rad: Angle to the true orientation [rad], shape (N,).
        nees: Squared error over the covariance, of six degrees of freedom, shape (N,).
        position_nees: That of the position alone, of three degrees of freedom, shape (N,).
        is_global: Whether the state claims to be tied to the map, shape (N,).
    """

    started_s: float
    stamps_s: Float
    error_m: Float
    error_rad: Float
    nees: Float
    position_nees: Float
    is_global: Float

    def near(self, at_s: float) -> float:
        """Return the error of the last judged state before a time [m]; inf if there is none."""
        before = np.flatnonzero(self.stamps_s < at_s)
        return float(self.error_m[before[-1]]) if len(before) else np.inf

    @property
    def inside(self) -> float:
        """Share of the states whose error is within the 95 % bound of their covariance."""
        return float((self.nees <= chi2.ppf(0.95, 6)).mean()) if len(self.nees) else 0.0


def judge(states: Sequence[BaseState], motion: Motion) -> Verdict:
    """Judge states at about ten a second."""
    chosen: list[BaseState] = []
    for state in states:
        if not chosen or state.stamp_s - chosen[-1].stamp_s >= _PERIOD_S - 1e-6:
            chosen.append(state)
    rows = [_row(state, motion) for state in chosen]
    table = np.array(rows, dtype=float).reshape(-1, 6)
    started_s = states[0].stamp_s if states else np.inf
    return Verdict(started_s, *table.T)


def _row(state: BaseState, motion: Motion) -> tuple[float, ...]:
    i = int(
        np.clip(np.searchsorted(motion.stamps_s, state.stamp_s - 1e-6), 0, len(motion.p_map) - 1)
    )
    R, p = state.T_map_cabin[:3, :3], state.T_map_cabin[:3, 3]
    turn = Rotation.from_matrix(R.T @ motion.R_map_body[i]).as_rotvec()
    error = np.concatenate([turn, R.T @ (motion.p_map[i] - p)])
    P = state.covariance
    nees = float(error @ np.linalg.solve(P, error))
    position_nees = float(error[3:] @ np.linalg.solve(P[3:, 3:], error[3:]))
    return (
        state.stamp_s,
        float(np.linalg.norm(error[3:])),
        float(np.linalg.norm(turn)),
        nees,
        position_nees,
        float(state.status == "GLOBAL"),
    )
