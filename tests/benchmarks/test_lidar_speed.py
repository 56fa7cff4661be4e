"""How long a pair of revolutions takes: 57,600 rays against ground, seven stones and the machine.

Run with `pytest tests/benchmarks -s`; the ordinary suite leaves it out, since its figure belongs to
the computer.
"""

import numpy as np
from executive_plugins.robot.mujoco.robot import MujocoRobot, MujocoSettings

from executive.clock import wall_s
from executive.machine.machine import load_machine
from executive.messages.command import SwitchLidars
from executive.messages.lidar import LidarScan


def test_a_pair_of_scans_costs_a_fraction_of_its_revolution() -> None:
    robot = MujocoRobot(MujocoSettings(), load_machine("m545"), np.random.default_rng(0))
    robot.start()
    robot.read(1.0)
    spans = []
    for lidars_on in (False, True):
        robot.command(SwitchLidars(lidars_on))
        start_s = robot.world.time_s
        observations = list(robot.read(start_s + 2.0))  # the firing patterns are laid out in here
        begun_s = wall_s()
        observations += robot.read(start_s + 6.0)
        spans.append(wall_s() - begun_s)
    scans = sum(isinstance(observation, LidarScan) for observation in observations)
    assert scans > 100
    pair_s = (spans[1] - spans[0]) / 40
    print(
        f"\n{1e3 * pair_s:.1f} ms a pair of scans; without lidars {4 / spans[0]:.0f} "
        "times real time"
    )
    assert pair_s < 0.05  # half a revolution on a busy computer; about 12 ms on an idle core
