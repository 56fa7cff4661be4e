"""One leaf's view of a running mission."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import numpy as np

from executive.arrays import Float
from executive.clock import Clock
from executive.errors import ConfigError, RobotError, did_you_mean
from executive.events.event import Event
from executive.interfaces.monitoring import Monitor
from executive.journal import Entry, Journal
from executive.leaf.context import Context
from executive.leaf.job import Job
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine
from executive.messages.base_state import BaseState
from executive.messages.ground_below import GroundBelow
from executive.messages.joints import JointSample
from executive.messages.region import Region
from executive.messages.verdict import Verdict
from executive.messages.weight import Weight
from executive.mission.assembly import seeded
from executive.mission.jobs.jobs import Jobs
from executive.mission.record.account import Account
from executive.mission.streams import Streams
from executive.tree.instances import chosen_key

Interface = TypeVar("Interface")
Arguments = ParamSpec("Arguments")
Value = TypeVar("Value")


@dataclass(slots=True)
class Services:
    """What the leaves of one mission share."""

    clock: Clock
    tick_s: float
    seed: int
    machine: Machine
    kinematics: Kinematics
    plugins: Mapping[str, Any]
    jobs: Jobs
    streams: Streams
    account: Account
    journal: Journal
    folder: Path
    record: Callable[[str, Event], None]
    show: Callable[[str, object], None]
    regions: Mapping[str, Region]
    verdicts: list[Verdict]
    trial_weights: list[Weight] = field(default_factory=list)  # of this hold

    def arm(self) -> Float:
        """Return the newest positions of the arm's joints, in the machine's order, shape (n,)."""
        sample = self.joints()
        return np.array([sample.of(name)[0] for name in self.machine.arm_names])

    def joints(self) -> JointSample:
        """Return the newest joint sample."""
        if self.streams.joints is None:
            raise RobotError("the robot has sent no joint sample yet")
        return self.streams.joints

    def gripper(self) -> Float:
        """Return T_map_gripper now, shape (4, 4)."""
        return np.asarray(self.streams.state().T_map_base @ self.kinematics.gripper(self.arm()))


class NodeContext(Context):
    """Hands a leaf snapshots, plugins and jobs, under its node's path."""

    def __init__(self, services: Services, node: str, uses: Mapping[str, str]) -> None:
        self._services = services
        self._node = node
        self._uses = uses
        self.draws = 0  # random generators that the leaf has asked for

    def now_s(self) -> float:
        return self._services.clock.now_s()

    def use(self, interface: Callable[..., Interface]) -> Interface:
        capability = str(getattr(interface, "capability", ""))
        key = chosen_key(capability, self._uses, self._services.plugins)
        if key is None:
            raise ConfigError(
                f"{self._node} uses a {capability or interface} plugin, and the mission selects "
                "none; name the interface in the leaf's 'needs'"
            )
        plugin: Interface = self._services.plugins[key]
        return plugin

    def start(
        self,
        verb: Callable[Arguments, Value],
        *args: Arguments.args,
        **kwargs: Arguments.kwargs,
    ) -> Job[Value]:
        return self._services.jobs.start(verb, *args, **kwargs)

    def rng(self) -> np.random.Generator:
        self.draws += 1
        return seeded(self._services.seed, self._node, self.draws)

    def state(self) -> BaseState:
        return self._services.streams.state()

    def joints(self) -> JointSample:
        return self._services.joints()

    def arm(self) -> Float:
        return self._services.arm()

    def gripper(self) -> Float:
        return self._services.gripper()

    def machine(self) -> Machine:
        return self._services.machine

    def region(self, name: str) -> Region:
        regions = self._services.regions
        if name not in regions:
            near = did_you_mean(name, regions)
            raise ConfigError(f"the mission has no region '{name}'{near}")
        return regions[name]

    def slot_places(self) -> Mapping[int, Float]:
        return self._services.account.slots

    def begin_hold(self) -> None:
        self._services.verdicts.clear()
        self._services.trial_weights.clear()
        for monitor in self._monitors():
            monitor.begin_hold()

    def begin_carry(self, weight: Weight | None = None) -> None:
        if weight is not None:
            self._services.trial_weights.append(weight)
        for monitor in self._monitors():
            monitor.begin_carry()

    def carry_over(self, below: GroundBelow) -> None:
        for monitor in self._monitors():
            monitor.carry_over(below)

    def end_hold(self) -> None:
        self._services.trial_weights.clear()
        for monitor in self._monitors():
            monitor.end_hold()

    def _monitors(self) -> Sequence[Monitor]:
        return self._services.streams.monitors

    def verdicts(self) -> tuple[Verdict, ...]:
        return tuple(self._services.verdicts)

    def weight(self) -> Weight | None:
        found = (monitor.weight() for monitor in self._monitors())
        return next((one for one in found if one is not None), None)

    def trial_weight(self) -> Weight | None:
        return next(reversed(self._services.trial_weights), None)

    def is_carried(self) -> bool:
        return any(monitor.is_carried() for monitor in self._monitors())

    def payload_kg(self) -> float | None:
        found = (monitor.payload_kg(self.joints()) for monitor in self._monitors())
        return next((one for one in found if one is not None), None)

    def standing(self) -> float | None:
        found = (monitor.standing() for monitor in self._monitors())
        return next((one for one in found if one is not None), None)

    def is_given_up(self, stone: int) -> bool:
        return stone in self._services.account.given_up

    def last_failure(self) -> str:
        return self._services.account.last_failure(self._node.rpartition("/")[0])

    def first_failure(self) -> str:
        return self._services.account.first_failure(self._node.rpartition("/")[0])

    def record(self, event: Event) -> None:
        self._services.record(self._node, event)

    def follow_journal(self) -> Callable[[], Sequence[Entry]]:
        journal, told = self._services.journal, self._services.journal.length

        def news() -> Sequence[Entry]:
            nonlocal told
            found = journal.since(told)
            told = journal.length
            return found

        return news

    def folder(self) -> Path:
        return self._services.folder

    def show(self, entity: str, value: object) -> None:
        self._services.show(entity, value)
