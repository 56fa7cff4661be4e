"""A running mission as the nodes of its tree see it: context, journal, questions, faults."""

import logging
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from types import TracebackType

from executive.events.event import Event
from executive.events.mission import Fault, Faulted, StopFailed
from executive.events.site import RegionNamed
from executive.faults.injector import Injector
from executive.interfaces.robot import Robot
from executive.leaf.claims import joints_of
from executive.leaf.runtime import MissionFaultError, Question, Runtime
from executive.leaf.store import Store
from executive.machine.kinematics import Kinematics
from executive.messages.cloud import Cloud
from executive.mission.braking import Braking
from executive.mission.context import NodeContext, Services
from executive.mission.display import Display
from executive.mission.guard import Guard
from executive.mission.jobs.notes import Noted, loop_in_leaf
from executive.mission.plugin_errors import PluginErrors, log
from executive.mission.record.leaf_memory import LeafMemory
from executive.mission.report import Ending
from executive.mission.setup import Setup
from executive.mission.stream_events import StreamEvents
from executive.mission.streams import Streams
from executive.mission.tick_times import LEAF
from executive.mission.wishes import Wishes
from executive.watch.watch import Decision


class _OwnCode:
    """A leaf's own code as a context: its time is charged to it, and its name is noted."""

    __slots__ = ("_noted", "_spent")

    def __init__(self, spent: AbstractContextManager[object], noted: Noted) -> None:
        self._spent, self._noted = spent, noted

    def __enter__(self) -> None:
        self._spent.__enter__()
        self._noted.__enter__()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._noted.__exit__(kind, error, trace)
        self._spent.__exit__(kind, error, trace)


@dataclass(frozen=True, slots=True)
class Put:
    """A question that was put to the operator by a node."""

    node: str
    text: str
    choices: tuple[str, ...]
    question: Question


class NodeRuntime(Runtime):
    """A running mission as the nodes of its tree see it, and what both share."""

    def __init__(self, setup: Setup) -> None:
        self.clock = setup.clock
        self.clock.start()
        self.store = Store()
        # For the report's truth: the newest survey.
        self.survey: Cloud | None = None
        self._setup = setup
        self.journal = setup.journal
        self.times = setup.jobs.times
        self.account = setup.account
        self._tick = 0  # of the mission: it stands still in a pause
        self._ending: Ending | None = None
        self._cut: Decision | None = None  # leaves that move the machine fail for it in this tick
        self.questions: list[Put] = []
        self.wishes = Wishes()
        plugins, machine = setup.assembly.plugins, setup.assembly.machine
        self._robot: Robot = plugins["robot"]
        self._errors = PluginErrors(plugins, setup.can_fail, self.record)
        self._events = events = StreamEvents(self.record, self.show, self._errors)
        self._display = Display(
            plugins.get("viewing"),
            setup.clock,
            lambda viewer, error: events.take_error("viewing", viewer, error),
        )
        self.injector = Injector(setup.guard.faults, machine, setup.seed, setup.clock)
        self.injector.install(plugins, lambda event: self.record("", event))
        setup.jobs.faults = self.injector
        self.guard = Guard(
            setup.guard, machine, plugins, setup.clock, lambda event: self.record("", event)
        )
        lidars = [name for name, sensor in machine.sensors.items() if sensor.kind == "lidar"]
        self.services = Services(
            clock=setup.clock,
            tick_s=setup.tick_s,
            seed=setup.seed,
            machine=machine,
            kinematics=Kinematics(machine),
            plugins=plugins,
            jobs=setup.jobs,
            streams=Streams(plugins, lidars, events, self.guard, setup.jobs),
            account=self.account,
            journal=setup.journal,
            folder=setup.folder,
            record=self.record,
            show=self.show,
            regions=setup.regions,
            verdicts=events.verdicts,
        )
        self.guard.bind(self.services.streams)
        self._braking = Braking(setup.clock, machine, self.record)
        self.memory: LeafMemory = setup.memory
        self.memory.bind(self.record)

    @property
    def is_ending(self) -> bool:
        """Whether it is settled how the mission ends."""
        return self._ending is not None

    @property
    def tick(self) -> int:
        """Return the number of the mission's tick; it stands still in a pause."""
        return self._tick

    # --- what the nodes see

    def context(self, node: str, uses: Mapping[str, str]) -> NodeContext:
        context = NodeContext(self.services, node, uses)
        self.memory.watch(node, context)
        return context

    def record(self, node: str, event: Event) -> None:
        if self.memory.took(node, event):
            return
        with self.times.spent("journal"):
            self.journal.append(self._tick, self.clock.now_s(), node, event)
        self.injector.heed(node, event)

    def within(self, node: str, leaf: str) -> "_OwnCode":
        return _OwnCode(self.times.spent(LEAF, node), loop_in_leaf(node, leaf))

    def show(self, entity: str, value: object) -> None:
        if entity == "survey" and isinstance(value, Cloud):
            self.survey = value
        with self.times.spent("display"):
            self._display.show(entity, value)

    def ask(
        self, node: str, question: str, default: bool | str | None, choices: Sequence[str] = ()
    ) -> Question:
        def put() -> Question:
            asked = self._setup.operator.ask(question, default, choices)
            self.questions.append(Put(node, question, tuple(choices), asked))
            return asked

        return self.memory.question(node, put)

    def let_go(self, node: str, parts: tuple[str, ...]) -> None:
        self._braking.add(node, parts, self.services.streams.joints)

    def still_driven(self, parts: tuple[str, ...]) -> str:
        return self._braking.awaited(parts)

    def cut_short(self, parts: tuple[str, ...]) -> str:
        if self._cut is None or not joints_of(parts, self.services.machine):
            return ""
        return f"watched condition '{self._cut.condition}': {self._cut.reason}"

    def keeps_failed(self, node: str, reason: str) -> bool:
        if self.wishes.pause_on_failure:
            self.wishes.hold(f"{node} failed: {reason}")
        return self.wishes.pause_on_failure

    def fail(self, error: Exception, node: str, leaf: str) -> str:
        if isinstance(error, MissionFaultError):
            raise error
        fault = self._errors.fault_of(error, node, leaf)
        if self._errors.excuses(fault):
            return fault.summary
        self._fault(fault)
        raise MissionFaultError(fault.summary) from error

    # --- faults

    def _safe_stop(self, reason: str) -> None:
        """Latch the machine's safe stop; an error of it is recorded, and nothing is lost by it."""
        try:
            self._robot.safe_stop(reason)
        except Exception as error:  # recorded and logged, and the mission ends all the same
            self.record("", StopFailed(f"{type(error).__name__}: {error}"))
            logging.getLogger(__name__).exception("the robot's safe stop failed")

    def _fault(self, fault: Fault) -> None:
        """Stop the machine for an error that escaped, and end the mission; the first one counts."""
        log(fault)
        self.record(fault.node, Faulted(fault))
        if not self.is_faulted:
            self.is_faulted = True
            self._ending = Ending("fault", fault.summary, fault)
        self._safe_stop(fault.summary)

    def _name_regions(self) -> None:
        for name, region in self.services.regions.items():
            self.record("", RegionNamed(name, region.corners_map))
            self.show(f"regions/{name}", region)
