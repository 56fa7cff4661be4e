import numpy as np
import pytest
from executive_plugins.motion.oil_flow import OilFlow
from executive_plugins.motion.path import path_through
from executive_plugins.motion.settings import HermiteSettings
from executive_plugins.motion.straight import time_line
from executive_plugins.motion.timing import Limits, time_path

from executive.machine.machine import load_machine
from executive.messages.trajectory import JointTrajectory

M545 = load_machine("m545")
FLOW = OilFlow.of(M545)
CARRY, ALL = M545.posture("carry"), np.array([1, -1, -1, 1, 1, -1, 1])
ONE = np.eye(len(CARRY))[3]


def limits(flow: OilFlow | None, share: float = 1.0) -> Limits:
    return Limits(share * M545.max_velocity, M545.max_acceleration, M545.max_jerk, flow)


def along(flow: OilFlow | None, *nodes: np.ndarray) -> JointTrajectory:
    is_dense = np.zeros(len(nodes) - 1, dtype=bool)
    path = path_through(np.array(nodes), is_dense, M545.max_velocity, M545.max_acceleration)
    return time_path(M545.arm_names, path, limits(flow))


def flow_m3_s(trajectory: JointTrajectory) -> float:
    times = np.linspace(0.0, trajectory.duration_s, 2000)
    return float(max(np.abs(trajectory.at(t)[1]) @ FLOW.displacement for t in times))


def test_a_line_takes_as_much_oil_as_there_is_and_no_more() -> None:
    fast, slow = (
        time_line(M545.arm_names, CARRY, CARRY + 0.5 * ALL, limits(flow)) for flow in (None, FLOW)
    )
    assert flow_m3_s(fast) > 1.1 * FLOW.most_m3_s
    assert flow_m3_s(slow) == pytest.approx(FLOW.most_m3_s, rel=1e-3)


@pytest.mark.parametrize("seed", range(5))
def test_a_path_takes_no_more_oil_than_there_is(seed: int) -> None:
    turns = np.random.default_rng(seed).uniform(-0.6, 0.6, (4, len(CARRY)))
    nodes = CARRY + np.cumsum(turns, axis=0)
    assert flow_m3_s(along(None, *nodes)) > FLOW.most_m3_s
    assert flow_m3_s(along(FLOW, *nodes)) <= 1.0001 * FLOW.most_m3_s


def test_a_path_is_slower_only_where_it_takes_too_much_oil() -> None:
    nodes = CARRY, CARRY + 1.5 * ONE, CARRY + 1.5 * ONE + 0.5 * ALL
    fast, slow = along(None, *nodes), along(FLOW, *nodes)
    assert flow_m3_s(slow) <= 1.0001 * FLOW.most_m3_s
    everywhere_s = fast.duration_s * flow_m3_s(fast) / FLOW.most_m3_s
    assert fast.duration_s < slow.duration_s < 0.95 * everywhere_s


def test_motions_with_enough_oil_are_as_they_were() -> None:
    nodes = CARRY, CARRY + 0.3 * ONE
    assert flow_m3_s(along(None, *nodes)) < FLOW.most_m3_s
    np.testing.assert_array_equal(along(None, *nodes).position, along(FLOW, *nodes).position)


def test_a_machine_without_hydraulics_refuses_the_limit() -> None:
    told = list(HermiteSettings(oil_flow="limited").refusals(load_machine("mini")))
    assert "mini has no hydraulics" in str(told)


def test_a_machine_without_hydraulics_has_no_limit_of_flow() -> None:
    assert OilFlow.of(M545.model_copy(update={"hydraulics": None})) is None
