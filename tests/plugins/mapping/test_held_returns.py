"""Returns of what the jaws hold, however long they hold it."""

import numpy as np
from executive_plugins.mapping.held_returns import HeldReturns


def test_the_oldest_returns_go_when_there_are_too_many() -> None:
    held = HeldReturns(0.05, most=10)
    for k in range(20):
        held.add(np.full((4, 3), float(k)))
        assert len(held.points()) <= 13
    np.testing.assert_array_equal(np.unique(held.points()), [17.0, 18.0, 19.0])


def test_one_scan_of_more_is_kept_whole() -> None:
    held = HeldReturns(0.05, most=10)
    held.add(np.zeros((3, 3)))
    held.add(np.ones((50, 3)))
    np.testing.assert_array_equal(held.points(), np.ones((50, 3)))


def test_a_few_are_all_kept_and_another_hold_begins_anew() -> None:
    held = HeldReturns(0.05, most=10)
    for k in range(3):
        held.add(np.full((3, 3), float(k)))
    held.add(np.empty((0, 3)))
    assert len(held.points()) == 9
    held.clear()
    held.add(np.full((9, 3), 4.0))
    assert len(held.points()) == 9
