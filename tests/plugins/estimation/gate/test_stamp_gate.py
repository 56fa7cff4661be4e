"""The stamp gate accepts increasing stamps, and recovers from wrong ones."""

import math

from executive_plugins.estimation.gate.stamp_gate import StampGate


def admitted(stamps, jump_s=0.5):
    door = StampGate()
    return [s for s in stamps if door.admits("imu", s, jump_s)], dict(door.refused)


def test_stamps_that_do_not_increase_are_refused_with_the_reason() -> None:
    good, refused = admitted([1.0, 1.1, 1.1, 0.9, math.nan, math.inf, 1.2])
    assert good == [1.0, 1.1, 1.2]
    assert refused == {"imu: duplicate": 1, "imu: back in time": 1, "imu: stamp not finite": 2}


def test_one_stamp_of_the_far_future_does_not_block_later_samples() -> None:
    good, refused = admitted([1.0, 1.1, 900.0, 1.2, 1.3])
    assert good == [1.0, 1.1, 1.2, 1.3]
    assert refused == {"imu: ahead of time": 1}


def test_a_gap_is_accepted_at_the_second_stamp_after_it() -> None:
    good, refused = admitted([1.0, 1.1, 9.0, 9.1, 9.2])
    assert good == [1.0, 1.1, 9.1, 9.2]
    assert refused == {"imu: ahead of time": 1}


def test_two_stamps_of_the_far_future_that_disagree_are_both_refused() -> None:
    assert admitted([1.0, 900.0, 300.0, 600.0, 1.1])[0] == [1.0, 1.1]


def test_two_stamps_of_the_far_future_that_agree_are_refused_if_good_ones_came_between() -> None:
    assert admitted([1.0, 900.0, 1.1, 900.1, 1.2])[0] == [1.0, 1.1, 1.2]


def test_a_first_stamp_of_the_far_future_is_replaced_by_the_second() -> None:
    assert admitted([900.0, 1.0, 1.1, 1.2])[0] == [900.0, 1.0, 1.1, 1.2]
    assert admitted([1.0, 0.9, 1.1])[0] == [1.0, 1.1]


def test_a_clock_that_was_set_back_is_followed_after_a_second() -> None:
    stamps = [50.0, 50.25, *(3.0 + k / 4 for k in range(8))]
    good, refused = admitted(stamps)
    assert good == [50.0, 50.25, 4.0, 4.25, 4.5, 4.75]
    assert refused == {"imu: back in time": 4, "imu: clock set back, followed": 1}


def test_late_samples_are_not_mistaken_for_a_clock_that_was_set_back() -> None:
    late = [3.0 + k / 4 for k in range(8)]
    assert admitted([50.0, 50.25, *late[:4], 50.5, *late[4:], 50.75])[0] == [
        50.0,
        50.25,
        50.5,
        50.75,
    ]
    assert admitted([50.0, 50.25, *reversed(late)])[0] == [50.0, 50.25]
    assert admitted([50.0, 50.25, *[3.0] * 9])[0] == [50.0, 50.25]


def test_streams_are_checked_separately() -> None:
    door = StampGate()
    assert door.admits("imu", 5.0)
    assert door.admits("joints", 1.0)
