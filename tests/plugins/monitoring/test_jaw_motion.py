"""Closing and opening of the jaws, on openings that the test makes."""

import numpy as np
import pytest
from executive_plugins.monitoring.jaw_motion import JawMotion
from executive_plugins.monitoring.settings import HoldStateSettings

SETTINGS = HoldStateSettings(
    slip=0.02, window=2.0, creep=0.05, lift_settle=1.0, lift_slip=0.4, empty=0.1
)
HELD_M = 0.8


def settled() -> JawMotion:
    """Jaws that held a stone while it settled in the lift, which began at 0 s and took a second."""
    motion = JawMotion(SETTINGS)
    motion.take(0.0, HELD_M + 0.1, 0.001, is_moving=True)
    motion.take(1.0, HELD_M, 0.001, is_moving=False)
    return motion


def test_nothing_is_compared_before_the_first_opening() -> None:
    motion = JawMotion(SETTINGS)
    assert np.isnan(motion.held_m)
    closed, widened = motion.take(0.0, HELD_M, 0.001, is_moving=False)
    assert (closed.value, widened.value) == (0.0, 0.0)
    assert motion.held_m == HELD_M


def test_before_the_stone_has_settled_closing_is_a_share_of_the_larger_slip() -> None:
    motion = JawMotion(SETTINGS)
    motion.take(0.0, HELD_M, 0.004, is_moving=True)
    closed, _ = motion.take(0.9, HELD_M - 0.1, 0.004, is_moving=True)
    assert (closed.value, closed.std) == pytest.approx((0.1 / 0.4, 0.004 / 0.4))


def test_an_arm_that_has_not_moved_settles_no_stone() -> None:
    motion = JawMotion(SETTINGS)
    motion.take(0.0, HELD_M, 0.004, is_moving=False)
    closed, _ = motion.take(50.0, HELD_M - 0.1, 0.004, is_moving=False)
    assert closed.value == pytest.approx(0.1 / 0.4)
    motion.take(60.0, HELD_M - 0.1, 0.004, is_moving=True)
    motion.take(60.9, HELD_M - 0.2, 0.004, is_moving=True)
    assert motion.held_m == HELD_M
    closed, widened = motion.take(61.0, HELD_M - 0.2, 0.004, is_moving=True)
    assert (motion.held_m, closed.value, widened.value) == (HELD_M - 0.2, 0.0, 0.0)


def test_a_stone_that_was_found_to_hang_has_settled() -> None:
    motion = JawMotion(SETTINGS)
    motion.take(0.0, HELD_M, 0.004, is_moving=True)
    motion.settle()
    closed, widened = motion.take(0.2, HELD_M - 0.2, 0.004, is_moving=True)
    assert (motion.held_m, closed.value, widened.value) == (HELD_M - 0.2, 0.0, 0.0)
    closed, _ = motion.take(0.3, HELD_M - 0.21, 0.004, is_moving=True)
    assert closed.value == pytest.approx(0.01 / 0.02)
    motion.settle()  # a second time changes nothing
    assert motion.held_m == HELD_M - 0.2


def test_quick_closing_is_a_share_of_the_slip_and_is_forgotten_after_the_window() -> None:
    motion = settled()
    closed, _ = motion.take(2.0, HELD_M - 0.01, 0.001, is_moving=True)
    assert (closed.value, closed.std) == pytest.approx((0.01 / 0.02, 0.001 / 0.02))
    closed, _ = motion.take(3.0, HELD_M - 0.01, 0.001, is_moving=True)
    assert closed.value == pytest.approx(0.5)  # the opening of two seconds ago still counts
    closed, _ = motion.take(3.01, HELD_M - 0.01, 0.001, is_moving=True)
    assert (closed.value, closed.std) == pytest.approx((0.01 / 0.05, 0.001 / 0.05))


def test_slow_closing_adds_up() -> None:
    motion = settled()
    for k in range(1, 50):  # 1 mm/s is 2 mm in a window
        closed, widened = motion.take(1.0 + k, HELD_M - 0.001 * k, 0.001, is_moving=True)
        assert closed.value == pytest.approx(max(min(0.001 * k, 0.002) / 0.02, 0.001 * k / 0.05))
        assert widened.value == 0.0


def test_opening_is_a_share_of_the_slip_from_the_narrowest_of_the_window() -> None:
    motion = settled()
    motion.take(2.0, HELD_M - 0.01, 0.001, is_moving=True)
    closed, widened = motion.take(2.5, HELD_M + 0.02, 0.002, is_moving=True)
    assert (widened.value, widened.std) == pytest.approx((0.03 / 0.02, 0.002 / 0.02))
    assert closed.value == 0.0
    _, widened = motion.take(4.1, HELD_M + 0.02, 0.002, is_moving=True)
    assert widened.value == 0.0


@pytest.mark.parametrize(("within_s", "forced"), [(0.2, 0.8), (0.4, 0.4)])
def test_what_forces_jaws_apart_at_once_is_no_creep(within_s: float, forced: float) -> None:
    """Both open by 8 mm, of which half of a slip is 10; the slow one by half of that at a time."""
    motion = settled()
    for share in (0.0, 0.5, 1.0):
        motion.take(2.0 + share * within_s, HELD_M + 0.008 * share, 0.001, is_moving=True)
    told = motion.forced(0.001)
    assert (told.value, told.std) == pytest.approx((forced, 0.1))


def test_jaws_that_were_forced_apart_are_so_until_the_window_has_passed() -> None:
    motion = settled()
    motion.take(1.1, HELD_M + 0.012, 0.001, is_moving=True)
    motion.take(2.0, HELD_M, 0.001, is_moving=True)
    assert motion.forced(0.001).value == pytest.approx(1.2)
    motion.take(3.2, HELD_M, 0.001, is_moving=True)
    assert motion.forced(0.001).value == 0.0
