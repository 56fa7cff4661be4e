"""A drive of the simulated machine that has lost its pressure holds or yields, as declared."""

import numpy as np
import pytest
from executive_plugins.robot.mujoco.robot import MujocoRobot
from executive_plugins.robot.mujoco.settings import MujocoSettings

from executive.machine.machine import load_machine

M545 = load_machine("m545")
WITHOUT_VALVES = M545.model_copy(
    update={
        "joints": [one.model_copy(update={"holds_without_pressure": False}) for one in M545.joints]
    }
)


def boom(robot, until_s):
    sample = [one for one in robot.read(until_s) if hasattr(one, "effort")][-1]
    i = sample.names.index("J_BOOM")
    return sample.position[i], sample.effort[i]


@pytest.mark.parametrize(("machine", "sinks"), [(M545, False), (WITHOUT_VALVES, True)])
def test_a_boom_without_pressure_sinks_unless_a_valve_holds_it(machine, sinks):
    """The pressure is measured before that valve, so that it is lost in either case."""
    settings = MujocoSettings.model_validate({"site": {"stones": {"count": 0}}})
    robot = MujocoRobot(settings, machine, np.random.default_rng(1))
    robot.start()
    try:
        sound, effort = boom(robot, 0.5)
        robot.weaken("J_BOOM", 0.0)
        later, lost = boom(robot, 1.5)
        assert bool(later < sound - 0.02) is sinks
        assert abs(lost) < 0.1 * abs(effort)
        if not sinks:
            assert later == pytest.approx(sound, abs=0.005)
    finally:
        robot.close()
