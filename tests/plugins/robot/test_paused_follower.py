"""Stops and pauses of a path with one joint at constant speed, counted by hand.

The joint moves at 1 rad/s and accelerates by 2 rad/s² at most. In steps of 0.01 s, ds/dt falls to 0
in 50 steps, in which s goes on by Σ (1 − 0.02 k) 0.01 = 0.245 s.
"""

from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.robot.trajectory_follower import Follower

from executive.errors import RobotError
from executive.messages.trajectory import JointTrajectory

DT_S = 0.01
LOST_S = 0.245


def machine(max_acceleration: float = 2.0) -> SimpleNamespace:
    return SimpleNamespace(
        arm_names=("J_TURN",),
        lower=np.array([-1.0]),
        upper=np.array([10.0]),
        max_velocity=np.array([1.0]),
        max_acceleration=np.array([max_acceleration]),
    )


def path(duration_s: float = 8.0, speed: float = 1.0, start: float = 0.0) -> JointTrajectory:
    positions = [[start], [start + speed * duration_s]]
    velocities = [[speed], [speed]]
    return JointTrajectory(("J_TURN",), np.array([0.0, duration_s]), positions, velocities)


def moving(duration_s: float = 8.0) -> Follower:
    """Return a follower that has followed a path for 2 s."""
    follower = Follower(machine(), np.zeros(1))
    follower.follow(path(duration_s), np.zeros(1))
    advance(follower, 200)
    return follower


def advance(follower: Follower, steps: int) -> tuple[float, float]:
    for _ in range(steps):
        position, velocity = follower.advance(DT_S)
    return float(position[0]), float(velocity[0])


def test_a_stop_takes_the_whole_acceleration_and_resuming_too() -> None:
    follower = moving()
    follower.stop()
    assert advance(follower, 25) == pytest.approx((2.0 + 0.01 * (25 - 0.02 * 325), 0.5))
    assert follower.is_moving
    assert advance(follower, 25) == pytest.approx((2.0 + LOST_S, 0.0))
    assert not follower.is_moving
    assert advance(follower, 30) == pytest.approx((2.0 + LOST_S, 0.0))
    follower.resume()
    assert follower.is_moving
    assert advance(follower, 50) == pytest.approx((2.0 + LOST_S + 0.255, 1.0))
    assert advance(follower, 10) == pytest.approx((2.6, 1.0))


def test_a_slow_path_stops_in_a_tenth_of_a_second_at_the_quickest() -> None:
    follower = Follower(machine(), np.zeros(1))
    follower.follow(path(speed=0.1), np.zeros(1))
    follower.stop()
    _, velocity = advance(follower, 9)
    assert velocity == pytest.approx(0.01)
    assert follower.is_moving
    assert advance(follower, 1)[1] == pytest.approx(0.0, abs=1e-12)


def test_a_second_stop_gives_the_path_up() -> None:
    for stops in (1, 2):
        follower = moving()
        for _ in range(stops):
            follower.stop()
        advance(follower, 60)
        follower.resume()
        assert follower.is_moving == (stops == 1)
    follower = moving()
    follower.give_up()
    follower.resume()
    advance(follower, 50)
    assert not follower.is_moving
    assert follower.behind_s() == 0.0
    follower.follow(path(4.0, start=2.0 + LOST_S), np.array([2.0 + LOST_S]))  # another path is free
    follower.stop()
    advance(follower, 50)
    follower.resume()
    assert follower.is_moving


def test_after_a_pause_accelerating_loses_what_braking_has_gained() -> None:
    follower = moving()
    follower.stop()
    follower.pause()
    advance(follower, 300)
    assert follower.behind_s() == pytest.approx(0.0, abs=1e-9)
    follower.resume()
    assert follower.behind_s() == pytest.approx(0.0, abs=1e-9)
    follower.go_on()
    # 3 s later it is where it would have been without the pause.
    assert advance(follower, 300)[0] == pytest.approx(5.0, abs=0.02)
    assert follower.behind_s() == pytest.approx(0.0, abs=0.02)


def test_time_in_which_the_mission_went_on_while_the_arm_braked_is_lost() -> None:
    """Half of the stop falls into the mission's time: 0.065 s are lost and 0.06 s gained."""
    follower = moving()
    follower.stop()
    advance(follower, 25)
    follower.pause()
    advance(follower, 100)
    assert follower.behind_s() == pytest.approx(LOST_S + 0.065 - 0.06)
    follower.go_on()
    follower.resume()
    position, _ = advance(follower, 100)
    assert position == pytest.approx(2.0 + 0.25 + 1.0 - 0.25, abs=0.02)


def test_an_arm_that_is_ahead_waits_before_it_accelerates() -> None:
    """It moved on for 0.1 s of the pause before it was stopped."""
    follower = moving()
    follower.pause()
    advance(follower, 10)
    follower.stop()
    advance(follower, 100)
    assert follower.behind_s() == pytest.approx(-0.1)
    stands = 2.0 + 0.1 + LOST_S
    follower.resume()
    follower.go_on()
    assert advance(follower, 10) == pytest.approx((stands, 0.0))
    assert advance(follower, 1) == pytest.approx((stands + 0.0002, 0.02))
    assert advance(follower, 189)[0] == pytest.approx(4.0, abs=0.02)


def test_at_half_its_speed_it_waits_twice_as_long() -> None:
    """At ds/dt = 0.5 each second of waiting loses half a second."""
    follower = moving()
    follower.pause()
    advance(follower, 10)
    follower.stop()
    advance(follower, 25)
    follower.resume()
    ahead_s = -follower.behind_s()
    gained_s = 0.1 + 0.01 * (25 - 0.02 * 325)
    assert ahead_s == pytest.approx(gained_s - 0.01 * sum(1 - 0.02 * k for k in range(26, 51)))
    follower.go_on()
    waits = round(2 * ahead_s / DT_S)
    assert advance(follower, waits)[1] == pytest.approx(0.5)
    assert advance(follower, 1)[1] == pytest.approx(0.52)


def test_near_its_end_a_path_has_less_to_lose() -> None:
    """From s = 2.245 it reaches 2.4 after 39 steps, in which 0.234 s are lost."""
    follower = moving(duration_s=2.4)
    follower.stop()
    follower.pause()
    advance(follower, 100)
    assert follower.behind_s() == pytest.approx(0.234 - LOST_S)
    follower.resume()
    position, velocity = advance(follower, 39)
    assert (position, velocity) == (pytest.approx(2.4), 0.0)
    assert not follower.is_moving
    assert follower.behind_s() == 0.0


def test_an_arm_at_rest_is_never_behind() -> None:
    follower = Follower(machine(), np.array([0.5]))
    follower.pause()
    assert advance(follower, 100) == (0.5, 0.0)
    assert follower.behind_s() == 0.0
    follower.go_on()
    follower.follow(path(start=0.5), np.array([0.5]))
    assert advance(follower, 1) == pytest.approx((0.51, 1.0))
    assert follower.behind_s() == pytest.approx(0.0)


def test_a_new_path_begins_in_step_with_the_mission() -> None:
    follower = moving()
    follower.pause()
    advance(follower, 10)
    follower.stop()
    advance(follower, 50)
    follower.go_on()
    here = follower.position()
    follower.follow(path(start=float(here[0]), duration_s=4.0), here)
    assert follower.behind_s() == pytest.approx(0.0)
    assert advance(follower, 1) == pytest.approx((float(here[0]) + 0.01, 1.0))


def test_want_of_oil_slows_the_path_down() -> None:
    follower = moving()
    position, velocity = follower.advance(DT_S, pace=0.25)
    assert (position.item(), velocity.item()) == pytest.approx((2.0025, 0.25))
    assert (follower.position().item(), follower.velocity().item()) == pytest.approx((2.0025, 1.0))


def test_what_is_kept_goes_on_where_it_was() -> None:
    follower, other = moving(), Follower(machine(), np.zeros(1))
    follower.stop()
    advance(follower, 20)
    other.restore(follower.keep())
    assert advance(other, 10) == advance(follower, 10)
    for one in (follower, other):
        one.resume()
    assert advance(other, 80) == advance(follower, 80)


@pytest.mark.parametrize(("off", "is_refused"), [(0.0009, False), (0.0011, True)])
def test_a_range_may_be_exceeded_by_a_milliradian(off: float, is_refused: bool) -> None:
    """Less than what encoders resolve, at either end."""
    for start, end in ((0.0, 10.0 + off), (0.0, -1.0 - off)):
        times = np.array([0.0, 20.0])
        trajectory = JointTrajectory(("J_TURN",), times, [[start], [end]], [[0.0], [0.0]])
        follower = Follower(machine(), np.zeros(1))
        if is_refused:
            with pytest.raises(RobotError, match=r"beyond -1\.0 … 10\.0"):
                follower.follow(trajectory, np.zeros(1))
        else:
            follower.follow(trajectory, np.zeros(1))
        assert follower.is_moving != is_refused


@pytest.mark.parametrize(("speed", "is_refused"), [(1.049, False), (1.051, True)])
def test_a_speed_may_be_exceeded_by_a_twentieth(speed: float, is_refused: bool) -> None:
    follower = Follower(machine(), np.zeros(1))
    if is_refused:
        with pytest.raises(RobotError, match=r"moves J_TURN at 1\.051 per second; its limit is 1"):
            follower.follow(path(speed=speed), np.zeros(1))
    else:
        follower.follow(path(speed=speed), np.zeros(1))
    assert follower.is_moving != is_refused


def test_a_path_must_begin_where_the_joint_is() -> None:
    follower = Follower(machine(), np.zeros(1))
    follower.follow(path(), np.array([0.049]))
    assert follower.is_moving
    with pytest.raises(RobotError, match=r"starts J_TURN at 0\.000, the joint is at -0\.051"):
        follower.follow(path(), np.array([-0.051]))
