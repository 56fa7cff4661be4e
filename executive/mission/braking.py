"""Cancelling as a state: what a cancelled leaf drove is free when the machine says it stands."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from executive.clock import Clock
from executive.errors import RobotError
from executive.events.event import Event
from executive.events.mission import PartsReleased
from executive.leaf.claims import Part, common, joints_of
from executive.leaf.rest import Rest, stop_limit_s
from executive.machine.machine import Machine
from executive.messages.joints import JointSample


class MachineMovesError(RobotError):
    """The machine does not come to rest."""


@dataclass(frozen=True, slots=True)
class _Claim:
    """What one cancelled leaf drove, until it stands."""

    node: str
    parts: tuple[str, ...]
    joints: tuple[str, ...]
    since_s: float
    limit_s: float
    least_s: float  # in which a chassis brakes: no joint shows it
    rest: Rest = field(default_factory=Rest)

    def stands(self, now_s: float, sample: JointSample) -> bool:
        """Return whether its joints are at rest, and its wheels have had the time to brake."""
        position, velocity, _ = np.array([sample.of(name) for name in self.joints]).T
        stands = self.rest.add(now_s, position, velocity)
        return stands and now_s - self.since_s >= self.least_s


class Braking:
    """The parts of the machine that cancelled leaves drove, and that still move.

    Times are the machine's: it goes on braking while the mission is paused.
    """

    def __init__(
        self, clock: Clock, machine: Machine, record: Callable[[str, Event], None]
    ) -> None:
        self._clock = clock
        self._machine = machine
        self._record = record
        self._claims: list[_Claim] = []

    def add(self, node: str, parts: tuple[str, ...], sample: JointSample | None) -> None:
        """Take the parts of a leaf that was cancelled; those that stand are free at once."""
        joints = joints_of(parts, self._machine)
        if not joints or sample is None:
            return
        now_s, limit_s = self._clock.machine_s(), stop_limit_s(self._machine, joints)
        driving, least_s = self._machine.driving, 0.0
        if Part.WHEELS in parts and driving is not None:
            least_s = driving.stop_s(driving.max_speed_m_s)
        claim = _Claim(node, parts, joints, now_s, limit_s + least_s, least_s)
        if not claim.stands(now_s, sample):
            self._claims.append(claim)

    def update(self, sample: JointSample | None) -> None:
        """Free what stands by the newest sample.

        Raises:
            MachineMovesError: If something moves longer than the machine's limits allow for.
        """
        if not self._claims or sample is None:
            return
        now_s = self._clock.machine_s()
        for claim in tuple(self._claims):
            taken_s = now_s - claim.since_s
            if claim.stands(now_s, sample):
                self._claims.remove(claim)
                self._record(claim.node, PartsReleased(claim.parts, round(taken_s, 6)))
            elif taken_s > claim.limit_s:
                raise MachineMovesError(
                    f"{' and '.join(claim.parts)} still move {taken_s:.1f} s after {claim.node} "
                    f"was cancelled; by the machine's limits they stand within {claim.limit_s:.1f} "
                    "s"
                )

    def awaited(self, parts: tuple[str, ...]) -> str:
        """Return what a leaf that drives parts must wait for; empty if it may begin."""
        for claim in self._claims:
            shared = common(claim.parts, parts)
            if shared:
                return f"{' and '.join(shared)} must stand first: {claim.node} was cancelled"
        return ""
