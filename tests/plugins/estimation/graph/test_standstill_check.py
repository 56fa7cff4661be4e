"""A chassis that looks as if it were at rest, but moves."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.measurements import Standstill
from executive_plugins.estimation.graph.settings import SmootherSettings
from executive_plugins.estimation.graph.standstill_check import StandstillCheck
from executive_plugins.estimation.inertial.state import VELOCITY, Inertial, InertialState

ARM = np.array([0.2, -0.3, -0.4])


def moving(v, rate=(0.0, 0.0, 0.0)) -> InertialState:
    sample = Inertial(1.0, np.array(rate, dtype=float), np.array([0.0, 0.0, 9.81]))
    return InertialState(
        sample, np.eye(3), np.zeros(3), np.array(v, dtype=float), np.zeros(3), np.zeros(3)
    )


def known(std_m_s: float) -> np.ndarray:
    P = 1e-8 * np.eye(15)
    P[VELOCITY, VELOCITY] = std_m_s**2 * np.eye(3)
    return P


@pytest.fixture
def belief() -> StandstillCheck:
    return StandstillCheck(SmootherSettings())


def test_a_drive_that_the_estimate_contains_is_not_mistaken_for_rest(belief) -> None:
    standing = Standstill(1.0, ARM, None)
    assert belief.contradicts(standing, moving([0.2, 0, 0]), known(0.01))
    assert not belief.is_accepted(1.9)
    assert belief.is_accepted(2.0)


def test_an_estimate_of_uncertain_speed_accepts_a_standstill(belief) -> None:
    assert not belief.contradicts(Standstill(1.0, ARM, None), moving([0.2, 0, 0]), known(0.2))
    assert belief.is_accepted(1.0)


def test_a_sensor_that_swings_about_the_turn_axis_counts_as_at_rest(belief) -> None:
    rate = np.array([0.0, 0.0, 0.8])
    swinging = moving(-np.cross(rate, ARM), rate)
    assert not belief.contradicts(Standstill(1.0, ARM, None), swinging, known(0.001))


@pytest.mark.parametrize("sway_m_s", [0.0, 0.2])
def test_a_sway_is_no_contradiction(belief, sway_m_s: float) -> None:
    swaying = Standstill(1.0, ARM, None, sway_m_s=sway_m_s)
    assert belief.contradicts(swaying, moving([0.2, 0, 0]), known(0.01)) == (sway_m_s == 0)


def test_a_standstill_is_as_uncertain_as_the_chassis_sways(belief) -> None:
    swaying = Standstill(1.0, ARM, np.zeros(3), sway_m_s=0.3, sway_rad_s=0.2)
    velocity, bias = belief.factors(0, swaying, moving([0, 0, 0]))
    assert velocity.noiseModel().sigmas() == pytest.approx(np.full(3, 0.3), rel=0.01)
    assert bias.noiseModel().sigmas()[-3:] == pytest.approx(np.full(3, 0.2), rel=0.01)


class Recorded:
    """Records which standstills a graph is given, and which it shall remove."""

    def __init__(self) -> None:
        self.added, self.removed_after = [], []

    def node_at(self, stamp_s: float) -> int:
        return 0

    def add(self, kind, stamp_s, factors) -> None:
        self.added.append((kind, stamp_s))

    def take_back(self, kind, after_s) -> None:
        self.removed_after.append((kind, after_s))


def test_a_standstill_is_given_to_each_graph_and_removed_after_a_contradiction(belief) -> None:
    graphs = [Recorded(), Recorded()]
    belief.take(Standstill(1.0, ARM, None), moving([0, 0, 0]), known(0.01), graphs)
    belief.take(Standstill(2.0, ARM, None), moving([0.2, 0, 0]), known(0.01), graphs)
    for graph in graphs:
        assert graph.added == [("standing", 1.0)]
        assert graph.removed_after == [("standing", 1.0)]
