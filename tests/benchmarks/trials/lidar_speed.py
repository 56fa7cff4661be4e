"""How long a pair of lidar revolutions takes: 57,600 rays against ground, seven stones, machine."""

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.robot.mujoco.robot import MujocoRobot
from executive_plugins.robot.mujoco.settings import MujocoSettings

from executive.clock import wall_s
from executive.machine.machine import load_machine
from executive.messages.command import SwitchLidars
from executive.messages.lidar import LidarScan

PAIR_MS = Bound(50.0, 9.0)  # half a revolution on a busy computer
PAIRS_HZ, SCANNED_S = 10, 4.0


def measured() -> list[Figure]:
    """Run the world for four seconds without and with its lidars."""
    robot = MujocoRobot(MujocoSettings(), load_machine("m545"), np.random.default_rng(0))
    robot.start()
    robot.read(1.0)
    spans_s, scans = [], 0
    for lidars_on in (False, True):
        robot.command(SwitchLidars(lidars_on))
        start_s = robot.world.time_s
        warm = list(robot.read(start_s + 2.0))  # the firing patterns are laid out in here
        begun_s = wall_s()
        observations = [*warm, *robot.read(start_s + 2.0 + SCANNED_S)]
        spans_s.append(wall_s() - begun_s)
        scans = sum(isinstance(observation, LidarScan) for observation in observations)
    pair_ms = 1e3 * (spans_s[1] - spans_s[0]) / (PAIRS_HZ * SCANNED_S)
    print(f"without lidars {SCANNED_S / spans_s[0]:.0f} times real time")
    return [
        held("a pair of scans [ms]", pair_ms, PAIR_MS),
        held("scans in six seconds", scans, Bound(100, is_least=True)),
    ]
