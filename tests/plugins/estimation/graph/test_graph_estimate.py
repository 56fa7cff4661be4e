"""What a graph reports of a receiver's clock that may agree."""

import numpy as np
import pytest
from executive_plugins.estimation.graph.graph_estimate import GraphEstimate
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.state import POSITION, Inertial, InertialState
from executive_plugins.estimation.kalman.agreeing_clock import AgreeingClock

Z = np.zeros(3)
SPEED_M_S, STD_S = 10.0, 0.02


def estimate(offset_s: float, agreeing: AgreeingClock | None) -> GraphEstimate:
    """Return one whose position errs along x by the speed times the clock's error, and 1 cm."""
    state = InertialState(Inertial(1.0, Z, Z), np.eye(3), Z, np.array([SPEED_M_S, 0, 0]), Z, Z)
    P, cross = 1e-4 * np.eye(15), np.zeros(15)
    x = POSITION.start
    P[x, x] += (SPEED_M_S * STD_S) ** 2
    cross[x] = SPEED_M_S * STD_S**2
    return GraphEstimate(state, P, ClockOffset(offset_s, STD_S, cross), agreeing)


def test_a_clock_that_does_not_agree_is_reported_as_it_was_estimated() -> None:
    one = estimate(0.01, None)
    state, P = one.reported()
    assert state is one.state
    assert P is one.covariance


@pytest.mark.parametrize(("offset_s", "is_nearer"), [(0.005, True), (0.2, False)])
def test_the_report_is_the_mean_of_a_clock_that_agrees_and_one_that_does_not(
    offset_s: float, is_nearer: bool
) -> None:
    """Were the clocks to agree, the position would err by the speed times the whole offset."""
    state, P = estimate(offset_s, AgreeingClock(0.5, 0.1)).reported()
    share = -float(state.p_map_imu[0]) / (SPEED_M_S * offset_s)
    assert (share > 0.5) == is_nearer
    assert 0.0 <= share < 1.0
    assert P[POSITION.start, POSITION.start] < 1e-4 + 1.01 * (SPEED_M_S * STD_S) ** 2
    assert (np.linalg.eigvalsh(P) > 0).all()
