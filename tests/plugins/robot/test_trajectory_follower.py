"""Following a trajectory: what is refused, and how a stop stays on the path and within
the limits.
"""

import numpy as np
import pytest
from executive_plugins.robot.trajectory_follower import Follower

from executive.errors import RobotError
from executive.machine.machine import Machine, load_machine
from executive.messages.trajectory import JointTrajectory

DT_S = 0.0025


@pytest.fixture
def machine() -> Machine:
    return load_machine("m545")


def quintic(machine: Machine, goal: np.ndarray, duration_s: float) -> JointTrajectory:
    """Move from the scanning posture to a goal with a fifth-order profile."""
    start, u = machine.posture("scan"), np.linspace(0, 1, 60)
    share, slope = (
        10 * u**3 - 15 * u**4 + 6 * u**5,
        (30 * u**2 - 60 * u**3 + 30 * u**4) / duration_s,
    )
    position = start + np.outer(share, goal - start)
    return JointTrajectory(
        machine.arm_names, u * duration_s, position, np.outer(slope, goal - start)
    )


def test_follows_to_the_end_and_holds(machine: Machine) -> None:
    goal = machine.posture("carry")
    follower = Follower(machine, machine.posture("scan"))
    follower.follow(quintic(machine, goal, 8.0), machine.posture("scan"))
    for _ in range(round(8.1 / DT_S)):
        position, velocity = follower.advance(DT_S)
    assert not follower.is_moving
    np.testing.assert_allclose(position, goal, atol=1e-9)
    np.testing.assert_array_equal(velocity, 0.0)


@pytest.mark.parametrize("stop_s", [0.5, 2.0, 3.3, 5.0, 6.5])
def test_a_stop_stays_on_the_path_within_the_acceleration_limits(
    machine: Machine, stop_s: float
) -> None:
    start, goal = machine.posture("scan"), machine.posture("carry") + np.eye(7)[0] * 1.5
    follower = Follower(machine, start)
    follower.follow(quintic(machine, goal, 7.0), start)
    positions, velocities = [], []
    for step in range(round(14.0 / DT_S)):
        if step == round(stop_s / DT_S):
            follower.stop()
        position, velocity = follower.advance(DT_S)
        positions.append(position)
        velocities.append(velocity)
    share = (np.array(positions) - start)[:, 0] / (goal - start)[0]
    # The path is a straight line in joint space (up to the Hermite pieces' 1e-6).
    np.testing.assert_allclose(
        np.array(positions), start + np.outer(share, goal - start), atol=1e-5
    )
    acceleration = np.abs(np.diff(velocities, axis=0)).max(axis=0) / DT_S
    assert (
        acceleration <= machine.max_acceleration * 1.05
    ).all()  # the pieces' acceleration jumps a little
    assert not follower.is_moving
    assert share[-1] < 1.0 or stop_s > 6.0


@pytest.mark.parametrize("is_given_up", [False, True])
def test_a_path_that_was_given_up_stays_so_in_a_world_that_is_taken_back(
    machine: Machine, is_given_up: bool
) -> None:
    follower, other = (Follower(machine, machine.posture("scan")) for _ in range(2))
    follower.follow(quintic(machine, machine.posture("carry"), 8.0), machine.posture("scan"))
    for _ in range(400):
        follower.advance(DT_S)
    follower.give_up() if is_given_up else follower.stop()
    follower.advance(DT_S)
    other.restore(follower.keep())
    other.resume()
    for _ in range(round(9.0 / DT_S)):
        position, _ = other.advance(DT_S)
    has_arrived = bool(np.allclose(position, machine.posture("carry")))
    assert has_arrived is not is_given_up


def test_a_stop_in_mid_swing_is_quick(machine: Machine) -> None:
    start = machine.posture("scan")
    follower = Follower(machine, start)
    follower.follow(quintic(machine, start + np.eye(7)[0] * 1.5, 6.0), start)
    for _ in range(round(3.0 / DT_S)):
        _, velocity = follower.advance(DT_S)
    follower.stop()
    steps = 0
    while follower.is_moving:
        follower.advance(DT_S)
        steps += 1
    shortest_s = velocity[0] / machine.max_acceleration[0]
    assert shortest_s * 0.95 <= steps * DT_S <= shortest_s * 1.2


def taken_s(
    machine: Machine, stop_s: float, *, is_urgent: bool = False, then_s: float | None = None
) -> tuple[float, float]:
    """Return how long a stop in mid-swing takes [s], and how far the joint turns meanwhile.

    The least time of a stop is changed to `then_s` just before it.
    """
    start = machine.posture("scan")
    follower = Follower(machine, start)
    follower.follow(quintic(machine, start + np.eye(7)[0] * 1.5, 6.0), start, stop_s)
    for _ in range(round(3.0 / DT_S)):
        began, _ = follower.advance(DT_S)
    if then_s is not None:
        follower.limit_stop(then_s)
    follower.give_up() if is_urgent else follower.stop()
    steps = 0
    while follower.is_moving:
        position, _ = follower.advance(DT_S)
        steps += 1
    return steps * DT_S, float(position[0] - began[0])


@pytest.mark.parametrize("stop_s", [1.5, 2.4])
def test_a_stop_takes_the_time_that_the_command_asks_for(machine: Machine, stop_s: float) -> None:
    """The speed, 15/8 of the mean at the middle of the swing, falls a little more than evenly."""
    seconds, turned = taken_s(machine, stop_s)
    assert seconds == pytest.approx(stop_s, abs=2 * DT_S)
    assert turned == pytest.approx(15 / 8 * 1.5 / 6.0 * stop_s / 2, rel=0.12)


def test_a_time_below_what_the_joints_need_makes_a_stop_no_quicker(machine: Machine) -> None:
    assert taken_s(machine, 0.2) == taken_s(machine, 0.0)


def test_a_stop_for_good_is_as_quick_as_the_joints_may(machine: Machine) -> None:
    assert taken_s(machine, 2.4, is_urgent=True) == taken_s(machine, 0.0)


@pytest.mark.parametrize("then_s", [0.0, 1.5])
def test_the_least_time_of_a_stop_may_change_on_the_way(machine: Machine, then_s: float) -> None:
    assert taken_s(machine, 2.4, then_s=then_s) == taken_s(machine, then_s)


def test_a_stop_for_good_is_slowed_by_nothing(machine: Machine) -> None:
    start = machine.posture("scan")
    follower = Follower(machine, start)
    follower.follow(quintic(machine, start + np.eye(7)[0] * 1.5, 6.0), start)
    for _ in range(round(3.0 / DT_S)):
        follower.advance(DT_S)
    follower.give_up()
    follower.limit_stop(2.4)
    steps = 0
    while follower.is_moving:
        follower.advance(DT_S)
        steps += 1
    assert steps * DT_S == taken_s(machine, 0.0)[0]


def test_a_slow_stop_goes_on_in_a_world_that_is_taken_back(machine: Machine) -> None:
    start, left = machine.posture("scan"), []
    follower, other = (Follower(machine, start) for _ in range(2))
    follower.follow(quintic(machine, start + np.eye(7)[0] * 1.5, 6.0), start, 2.0)
    for _ in range(round(3.0 / DT_S)):
        follower.advance(DT_S)
    follower.stop()
    follower.advance(DT_S)
    other.restore(follower.keep())
    for one in (follower, other):
        while one.is_moving:
            position, _ = one.advance(DT_S)
        left.append(position)
    np.testing.assert_array_equal(*left)


def test_joints_that_are_not_named_hold(machine: Machine) -> None:
    start = machine.posture("scan")
    follower = Follower(machine, start)
    follower.follow(
        JointTrajectory(("J_TELE",), np.array([0.0, 2.0]), [[0.0], [0.3]], [[0.0], [0.0]]), start
    )
    for _ in range(round(2.1 / DT_S)):
        position, _ = follower.advance(DT_S)
    np.testing.assert_allclose(position, start + 0.3 * np.eye(7)[3], atol=1e-12)


@pytest.mark.parametrize(
    ("joint", "positions", "words"),
    [
        ("J_KNEE", (0.0, 0.1), "J_KNEE; the arm has J_TURN"),
        ("J_TURN", (0.2, 0.3), "starts J_TURN at 0.200, the joint is at 0.000"),
        ("J_TELE", (0.0, 1.9), "J_TELE to 0.000 … 1.900, beyond -0.031 … 1.769"),
    ],
)
def test_refuses_what_the_arm_cannot_do(
    machine: Machine, joint: str, positions: tuple[float, float], words: str
) -> None:
    follower = Follower(machine, machine.posture("scan"))
    trajectory = JointTrajectory(
        (joint,), np.array([0.0, 20.0]), np.c_[positions].T, np.zeros((2, 1))
    )
    with pytest.raises(RobotError, match=words):
        follower.follow(trajectory, machine.posture("scan"))
    assert not follower.is_moving


@pytest.mark.parametrize(("way", "is_followed"), [(-0.1, True), (0.01, False)])
def test_a_joint_pressed_beyond_its_range_may_move_back_and_no_farther(
    machine: Machine, way: float, is_followed: bool
) -> None:
    start, roll = machine.posture("scan"), machine.arm_names.index("J_EE_ROLL")
    start[roll] = machine.upper[roll] + 0.004
    u = np.linspace(0, 1, 20)[:, None]
    slope = np.eye(len(start))[roll] * way
    path = JointTrajectory(
        machine.arm_names, u[:, 0] * 2.0, start + u * slope, np.tile(slope / 2.0, (20, 1))
    )
    follower = Follower(machine, start)
    if is_followed:
        follower.follow(path, start)
        assert follower.is_moving
    else:
        with pytest.raises(RobotError, match="takes J_EE_ROLL"):
            follower.follow(path, start)


def test_refuses_a_speed_beyond_the_limit(machine: Machine) -> None:
    follower = Follower(machine, machine.posture("scan"))
    trajectory = JointTrajectory(("J_TURN",), np.array([0.0, 1.0]), [[0.0], [1.0]], [[0.0], [1.0]])
    with pytest.raises(RobotError, match=r"J_TURN at 1\.000 per second; its limit is 0\.8"):
        follower.follow(trajectory, machine.posture("scan"))


def test_refuses_a_piece_that_swings_beyond_a_range_between_its_samples(machine: Machine) -> None:
    follower = Follower(machine, machine.posture("scan"))
    velocity = [[-0.38], [0.38]]  # the cubic between two samples at 0 dips by h·v/4 = 0.095 m
    trajectory = JointTrajectory(("J_TELE",), np.array([0.0, 1.0]), [[0.0], [0.0]], velocity)
    with pytest.raises(RobotError, match="beyond"):
        follower.follow(trajectory, machine.posture("scan"))
