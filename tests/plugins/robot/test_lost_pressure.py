"""A drive of the simulated machine that has lost its pressure yields, and holds again with it."""

import numpy as np
from executive_plugins.robot.mujoco.robot import MujocoRobot
from executive_plugins.robot.mujoco.settings import MujocoSettings

from executive.machine.machine import load_machine


def boom(robot, until_s):
    sample = [one for one in robot.read(until_s) if hasattr(one, "effort")][-1]
    return sample.of("J_BOOM")[0]


def test_a_boom_without_pressure_sinks():
    settings = MujocoSettings.model_validate({"site": {"stones": {"count": 0}}})
    robot = MujocoRobot(settings, load_machine("m545"), np.random.default_rng(1))
    robot.start()
    try:
        sound = boom(robot, 0.5)
        robot.weaken("J_BOOM", 0.0)
        assert boom(robot, 1.0) < sound - 0.02
    finally:
        robot.close()
