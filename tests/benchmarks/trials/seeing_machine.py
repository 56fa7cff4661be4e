"""A kinematic machine behind the wire whose lidars see flat ground."""

import signal
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from executive.geometry.pose import inverse, transform
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine, load_machine
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.observation import Observation
from executive.registry import load, settings_of
from executive.wire.address import Address
from executive.wire.machine_server import MachineServer
from trials.supervisor import noting

_PERIOD_S = 0.1
_GROUND = 10  # points a side
_SIDE_M = 8.0
_AWAY_M = 10.0  # of the middle of what is seen, in front of the base


def serve(address: str, silence_s: float, note: Path) -> None:
    """Serve the machine; it notes when it is told to stop, and why."""
    model = load_machine("m545")
    robot: Any = load("robot", "kinematic")(settings_of("robot", "kinematic")(), model)
    read, lidars = robot.read, Lidars(model)
    robot.read = lambda until_s: lidars.with_scans(read(until_s))
    server = MachineServer(robot, "m545", Address.parse(address), silence_s)
    noting(robot, note)
    signal.signal(signal.SIGTERM, lambda *_: setattr(server, "is_ended", True))
    server.run()


class Lidars:
    """Adds a revolution of each lidar, ten times a second."""

    def __init__(self, machine: Machine) -> None:
        self._kinematics = Kinematics(machine)
        self._arm = len(machine.arm_names)
        self._frames = [name for name, sensor in machine.sensors.items() if sensor.kind == "lidar"]
        side = np.linspace(-_SIDE_M / 2, _SIDE_M / 2, _GROUND)
        x, y = np.meshgrid(_AWAY_M + side, side)
        height = np.full(x.size, -machine.stance.base_height_m)
        self._ground_base = np.column_stack([x.ravel(), y.ravel(), height])
        self._due_s = 0.0

    def with_scans(self, observations: Sequence[Observation]) -> list[Observation]:
        """Return observations with the scans that were due among them."""
        found: list[Observation] = []
        for one in observations:
            found.append(one)
            if isinstance(one, JointSample) and one.stamp_s >= self._due_s:
                self._due_s = one.stamp_s + _PERIOD_S
                found += self._scans(one)
        return found

    def _scans(self, sample: JointSample) -> Iterator[LidarScan]:
        frames = self._kinematics.frames(sample.position[: self._arm])
        for name in self._frames:
            points = transform(inverse(frames[name]), self._ground_base)
            stamps = np.full(len(points), sample.stamp_s)
            yield LidarScan(sample.stamp_s, name, points, stamps)
