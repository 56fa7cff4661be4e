"""The filter over the states of a grip, against the mathematics of a Bayes filter."""

import numpy as np
import pytest
from executive_plugins.monitoring.grip_state import GripFilter, GripState, Signal, Signals

from executive.arrays import Float

UNKNOWN = Signal(float("nan"), 1.0)
SWITCH = 1e-3  # probability of a change to another given state
STATES = tuple(GripState)
STEADY, GONE, HELD = Signal(0.0, 0.01), Signal(0.0, 0.05), Signal(1.0, 0.05)


def signals(
    weight: Signal = HELD,
    force: Signal = HELD,
    closed: Signal = STEADY,
    widened: Signal = STEADY,
    forced: Signal = STEADY,
    may_stand: bool = False,
    has_settled: bool = False,
    has_slipped: bool = False,
) -> Signals:
    return Signals(weight, force, closed, widened, forced, may_stand, has_settled, has_slipped)


def likeliest(seen: Signals, windows: int = 4) -> GripState:
    grip = GripFilter()
    for _ in range(windows):
        likely = grip.update(seen)
    assert sum(likely.values()) == pytest.approx(1.0)
    return max(likely, key=lambda state: likely[state])


def predicted(p: Float) -> Float:
    """Return probabilities after a window in which each state may have become another one."""
    n = len(p)
    A = (1 - n * SWITCH) * np.eye(n) + SWITCH * np.ones((n, n))
    return np.asarray(A @ p)


def test_what_was_not_measured_leaves_what_time_makes_of_the_first_guess() -> None:
    """Only being lost, or on the ground, cannot be told then: they are excluded."""
    nothing = signals(UNKNOWN, UNKNOWN, UNKNOWN, UNKNOWN)
    told = (GripState.FIRM, GripState.CREEPING, GripState.SLIPPING, GripState.OPENING)
    p = np.where([one is GripState.FIRM for one in STATES], 1 - 6 * SWITCH, SWITCH)
    grip = GripFilter()
    for _ in range(5):
        likely = grip.update(nothing)
        p = np.where([one in told for one in STATES], predicted(p), 0.0)
        p /= p.sum()
        np.testing.assert_allclose([likely[one] for one in STATES], p, rtol=1e-9, atol=1e-15)


@pytest.mark.parametrize(("closed", "n_sigma"), [(0.2, 0.0), (0.3, 1.0), (0.4, 2.0)])
def test_the_likelihood_of_a_state_is_that_of_the_nearest_point_of_its_region(
    closed: float, n_sigma: float
) -> None:
    """A firm grip has closed by at most a fifth of a slip; one that creeps, by more."""
    likely = GripFilter().update(signals(closed=Signal(closed, 0.1)))
    first = predicted(np.where([one is GripState.FIRM for one in STATES], 1 - 6 * SWITCH, SWITCH))
    prior = dict(zip(STATES, first, strict=True))
    expected = prior[GripState.FIRM] * np.exp(-0.5 * n_sigma**2) / prior[GripState.CREEPING]
    assert likely[GripState.FIRM] / likely[GripState.CREEPING] == pytest.approx(expected)


@pytest.mark.parametrize(
    ("seen", "expected"),
    [
        (signals(), GripState.FIRM),
        (signals(closed=Signal(0.6, 0.05)), GripState.CREEPING),
        (signals(closed=Signal(1.3, 0.05)), GripState.SLIPPING),
        (signals(force=Signal(0.3, 0.02)), GripState.OPENING),
        (signals(widened=Signal(5.0, 0.1)), GripState.OPENING),
        (signals(widened=Signal(3.0, 0.1)), GripState.FIRM),  # forced apart by a stone that seats
        (signals(GONE, GONE), GripState.LOST),
        # Once it hangs, only a stone that slides or turns forces the jaws apart.
        (signals(widened=Signal(3.0, 0.1), has_settled=True), GripState.OPENING),
        # So does one that slides by jerks, and rests in between; what comes down may, too.
        (signals(forced=Signal(1.2, 0.05), has_settled=True), GripState.OPENING),
        (signals(forced=Signal(0.8, 0.05), has_settled=True), GripState.FIRM),
        (signals(forced=Signal(1.2, 0.05), may_stand=True, has_settled=True), GripState.FIRM),
        # Jaws that shake on a stone that slides are no jaws that have lost it.
        (
            signals(closed=Signal(1.5, 0.1), widened=Signal(2.0, 0.1), has_settled=True),
            GripState.SLIPPING,
        ),
        # Jaws that press with more than a fifth of their force bear on something.
        (signals(GONE, Signal(0.1, 0.01)), GripState.LOST),
        (signals(GONE, Signal(0.3, 0.01)), GripState.TOUCHING_GROUND),
        (signals(GONE, closed=Signal(3.0, 0.1)), GripState.TOUCHING_GROUND),
        (signals(GONE, closed=Signal(5.0, 0.1)), GripState.SLID_DOWN),
        # A stone that hung, and that the gripper has not sunk with, has left the jaws.
        (signals(GONE, has_settled=True), GripState.LOST),
        (signals(GONE, may_stand=True, has_settled=True), GripState.TOUCHING_GROUND),
        # One that slides out of still jaws hangs on their friction: two thirds are no whole weight,
        # but where the ground may carry the rest.
        (signals(Signal(0.66, 0.03), has_settled=True), GripState.LOST),
        (signals(Signal(0.85, 0.03), has_settled=True), GripState.FIRM),
        (signals(Signal(0.66, 0.03), has_settled=True, has_slipped=True), GripState.FIRM),
        (signals(Signal(0.66, 0.03), may_stand=True, has_settled=True), GripState.FIRM),
        # An arm that is pushed up by more than the stone weighs stands on something.
        (signals(Signal(-0.8, 0.02), GONE), GripState.LOST),
        (signals(Signal(-1.3, 0.02), GONE), GripState.TOUCHING_GROUND),
        # Without measured forces the jaws' motion decides, or whether it may stand.
        (signals(GONE, UNKNOWN), GripState.LOST),
        (signals(GONE, UNKNOWN, may_stand=True), GripState.TOUCHING_GROUND),
    ],
)
def test_each_state_is_told_by_its_signals(seen: Signals, expected: GripState) -> None:
    assert likeliest(seen) is expected


@pytest.mark.parametrize(
    ("value", "expected"), [(0.1, 4.0), (0.3, 0.0), (0.5, 0.0), (0.7, 0.0), (1.1, 16.0)]
)
def test_a_signal_is_off_by_its_distance_from_an_interval(value: float, expected: float) -> None:
    assert Signal(value, 0.1).off(0.3, 0.7) == pytest.approx(expected)
    assert UNKNOWN.off(0.3, 0.7) == 0.0
