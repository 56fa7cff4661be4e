import numpy as np
import pytest
from executive_plugins.motion.oil_flow import within_flow
from executive_plugins.motion.settings import HermiteSettings
from executive_plugins.motion.straight import time_line
from executive_plugins.motion.timing import Limits

from executive.machine.machine import load_machine
from executive.messages.trajectory import JointTrajectory

M545 = load_machine("m545")


def motion(share: float) -> JointTrajectory:
    """Return a motion of all joints at once, at a share of their largest speeds."""
    limits = Limits(share * M545.max_velocity, M545.max_acceleration, M545.max_jerk)
    start = M545.posture("carry")
    goal = start + 0.5 * np.array([1, -1, -1, 1, 1, -1, 1])
    return time_line(M545.arm_names, start, goal, limits)


def flow_m3_s(trajectory: JointTrajectory) -> float:
    assert M545.hydraulics is not None
    taken = np.array([M545.hydraulics.displacement[name] for name in trajectory.names])
    times = np.linspace(0.0, trajectory.duration_s, 500)
    return float(max(np.abs(trajectory.at(t)[1]) @ taken for t in times))


def test_a_motion_that_asks_for_too_much_oil_is_slowed_along_its_path() -> None:
    assert M545.hydraulics is not None
    fast = motion(1.0)
    slow = within_flow(fast, M545)
    assert flow_m3_s(fast) > M545.hydraulics.pump_flow_m3_s > flow_m3_s(slow)
    assert np.array_equal(slow.position, fast.position)
    middle = slow.duration_s / 2
    assert slow.at(middle)[0] == pytest.approx(fast.at(fast.duration_s / 2)[0], abs=1e-9)


def test_a_motion_with_enough_oil_is_left_alone() -> None:
    slow = motion(0.2)
    assert within_flow(slow, M545) is slow


def test_a_machine_without_hydraulics_refuses_the_limit() -> None:
    told = list(HermiteSettings(oil_flow="limited").refusals(load_machine("mini")))
    assert "mini has no hydraulics" in str(told)


def test_a_machine_without_hydraulics_has_no_limit_of_flow() -> None:
    fast = motion(1.0)
    assert within_flow(fast, M545.model_copy(update={"hydraulics": None})) is fast
