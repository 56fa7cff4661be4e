"""The wait for the machine to come to rest, which its limits bound."""

from collections.abc import Mapping
from typing import Any

from executive.clock import Clock
from executive.interfaces.robot import Robot
from executive.leaf.rest import Rest, stop_limit_s
from executive.machine.machine import Machine
from executive.messages.joints import JointSample
from executive.mission.braking import MachineMovesError
from executive.supervision.beacon import beacon


def brake_s(machine: Machine, plugins: Mapping[str, Any]) -> float:
    """Return how long a chassis that was told to stop may still roll [s]; 0 if it never drives."""
    driving = machine.driving
    if driving is None or "driving" not in plugins:
        return 0.0
    return driving.stop_s(driving.max_speed_m_s)


class Standstill:
    """Looks whether a machine that was told to stop is at rest, in the machine's time."""

    def __init__(self, clock: Clock, machine: Machine, brake_s: float = 0.0) -> None:
        """Begin to look.

        Args:
            clock: The mission's clock.
            machine: Limits of its joints.
            brake_s: How long its chassis may still roll: no joint shows that [s].
        """
        self._clock, self._brake_s = clock, brake_s
        self._rest = Rest()
        self._limit_s = stop_limit_s(machine, machine.joint_names)
        self._began_s = clock.machine_s()

    def reached(self, sample: JointSample | None) -> bool:
        """Return whether all joints are at rest, and the chassis is; true without any sample.

        Raises:
            MachineMovesError: If they move longer than the machine's limits allow for.
        """
        now_s = self._clock.machine_s()
        if sample is None:
            return True
        if self._rest.add(now_s, sample.position, sample.velocity):
            return now_s - self._began_s >= self._brake_s
        if now_s - self._began_s >= self._limit_s:
            raise MachineMovesError(f"the machine still moves {self._limit_s:.1f} s after the stop")
        return False

    def await_alone(self, robot: Robot, sample: JointSample | None, tick_s: float) -> int:
        """Read the robot, and nothing else, until it is at rest; return the number of ticks.

        Raises:
            MachineMovesError: If it moves for too long.
        """
        ticks = 0
        while not self.reached(sample):
            self._clock.advance(tick_s)
            ticks += 1
            beacon().beat()
            found = robot.read(self._clock.machine_s())
            sample = next((one for one in reversed(found) if isinstance(one, JointSample)), sample)
        return ticks
