"""A running mission: the tick loop and the safe stop."""

import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from executive.clock import Clock, wall_s
from executive.errors import RobotError
from executive.events.event import Event
from executive.events.mission import (
    EstimatorStatusChanged,
    Fault,
    Faulted,
    MissionEnded,
    ObservationIgnored,
    PhaseChanged,
    PluginFailed,
    StopFailed,
    VerdictGiven,
)
from executive.events.site import RegionNamed
from executive.events.watch import MissionHeld, MissionWentOn
from executive.faults.injector import Injector
from executive.geometry.pose import inverse
from executive.geometry.rotation import log_so3
from executive.interfaces.plugin import Plugin
from executive.interfaces.robot import Robot
from executive.journal import Journal
from executive.leaf.rest import Rest
from executive.leaf.runtime import MissionFaultError, Question, Runtime
from executive.leaf.store import Store
from executive.logs.recorder import Recorder
from executive.machine.kinematics import Kinematics
from executive.messages.base_state import BaseState
from executive.messages.cloud import Cloud
from executive.messages.joints import JointSample
from executive.messages.region import Region
from executive.messages.status_change import StatusChange
from executive.messages.stone import Stone
from executive.messages.verdict import Verdict
from executive.mission.assembly import Assembly
from executive.mission.context import NodeContext, Services
from executive.mission.display import Display
from executive.mission.fault import fault_of
from executive.mission.guard import Guard, GuardSettings, failure_of
from executive.mission.jobs.jobs import Jobs
from executive.mission.operator import Operator
from executive.mission.phase import Phase, checked_change
from executive.mission.record.account import Account
from executive.mission.record.keeper import Instant, Keeper
from executive.mission.record.leaf_memory import LeafMemory
from executive.mission.record.observation import Observation
from executive.mission.record.resumption import PastClock, Resumption
from executive.mission.report import Ending
from executive.mission.streams import StreamListener, Streams
from executive.supervision.beacon import beacon
from executive.tree.build import node_states
from executive.watch.watch import Decision, Wish

_STOP_LIMIT_S = 10.0  # a machine that has not come to rest by then is faulted
_STATE_PERIOD_S = 1.0  # of the estimates kept for the report
_VIEW_PERIOD_S = 0.2  # of poses and tree states handed to the viewer


@dataclass(frozen=True, slots=True)
class Setup:
    """What a mission is made of."""

    clock: Clock
    tick_s: float
    time_limit_s: float
    seed: int
    assembly: Assembly
    jobs: Jobs
    journal: Journal
    account: Account
    operator: Operator
    memory: LeafMemory
    keeper: Keeper
    folder: Path
    recorder: Recorder | None = None
    regions: Mapping[str, Region] = field(default_factory=dict)
    can_fail: frozenset[tuple[str, str]] = frozenset()  # capability and name: `on_error: fail`
    guard: GuardSettings = field(default_factory=GuardSettings)
    heartbeat_limit_s: float = 0.0  # the supervisor stops a loop that is silent for longer; 0: none


class MachineMovesError(RobotError):
    """The machine does not come to rest."""


class Mission(Runtime, StreamListener):
    """The tick loop: read → streams → tree → commands → journal, viewer."""

    def __init__(
        self, setup: Setup, build: Callable[[Runtime], Any], halt: Callable[[Any], None]
    ) -> None:
        self.clock = setup.clock
        self.store = Store()
        self.phase = Phase.IDLE
        self.states: list[BaseState] = []
        # For the report's truth: each stone as it was first shown, and the newest survey.
        self.first_stones: dict[int, Stone] = {}
        self.survey: Cloud | None = None
        self._setup = setup
        self.journal = setup.journal
        self.account = setup.account
        self._tick = 0
        self._ticked_s = 0.0  # when the tree was ticked last
        self._ending: Ending | None = None
        self._stop_requested = False
        self._pause_requested = False
        self._questions: list[Question] = []
        self._robot: Robot = setup.assembly.plugins["robot"]
        self._display = Display(
            setup.assembly.plugins.get("viewing"),
            setup.clock,
            lambda viewer, error: self.take_error("viewing", viewer, error),
        )
        machine, plugins = setup.assembly.machine, setup.assembly.plugins
        self.injector = Injector(setup.guard.faults, machine, setup.seed, setup.clock)
        self.injector.install(plugins, lambda event: self.record("", event))
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
            plugins=setup.assembly.plugins,
            jobs=setup.jobs,
            streams=Streams(setup.assembly.plugins, lidars, self, self.guard),
            account=self.account,
            journal=setup.journal,
            folder=setup.folder,
            record=self.record,
            show=self.show,
            regions=setup.regions,
        )
        self.guard.bind(self.services.streams)
        self._before_hold: tuple[float, BaseState, bool] | None = None
        self._halt = halt
        self.memory: LeafMemory = setup.memory
        self.memory.bind(self.record)
        self.root = build(self)

    # --- what the nodes see

    def context(self, node: str, uses: Mapping[str, str]) -> NodeContext:
        context = NodeContext(self.services, node, uses)
        self.memory.watch(node, context)
        return context

    def record(self, node: str, event: Event) -> None:
        if self.memory.took(node, event):
            return
        self.journal.append(self._tick, self.clock.now_s(), node, event)
        self.injector.heed(node, event)

    def show(self, entity: str, value: object) -> None:
        if isinstance(value, Stone):
            self.first_stones.setdefault(value.id, value)
        if entity == "survey" and isinstance(value, Cloud):
            self.survey = value
        self._display.show(entity, value)

    def ask(
        self, node: str, question: str, default: bool | str | None, choices: Sequence[str] = ()
    ) -> Question:
        def put() -> Question:
            asked = self._setup.operator.ask(question, default, choices)
            self._questions.append(asked)
            return asked

        return self.memory.question(node, put)

    def fail(self, error: Exception, node: str, leaf: str) -> str:
        if isinstance(error, MissionFaultError):
            raise error
        fault = fault_of(error, self.services.plugins, node, leaf)
        if (fault.capability, fault.name) in self._setup.can_fail:
            self._log(fault)
            self.record(node, PluginFailed(fault))
            return fault.summary
        self._fault(fault)
        raise MissionFaultError(fault.summary) from error

    # --- what people do

    def request_stop(self) -> None:
        """Stop along the path at the next tick, then end."""
        self._stop_requested = True

    def toggle_pause(self) -> None:
        """Pause at the next tick, or go on."""
        self._pause_requested = not self._pause_requested

    # --- the loop

    def run(self, after_tick: Callable[["Mission"], None]) -> Ending:
        """Tick until the tree has ended or the mission is stopped; the machine is then at rest."""
        self._change(Phase.RUNNING, "")
        for name, region in self.services.regions.items():
            self.record("", RegionNamed(name, region.corners_map))
            self.show(f"regions/{name}", region)
        try:
            if self.memory.history is not None:
                self._observe_anew(after_tick)
            while self._ending is None:
                self._guarded_tick()
                after_tick(self)
        finally:  # also when the operator ends it at once: a leaf's clean-up needs the robot
            self._halt(self.root)
        if self._ending.outcome != "fault":
            self._change(Phase.STOPPING, self._ending.reason)
            self._come_to_rest(after_tick)
        self._change(
            Phase.FAULTED if self._ending.outcome == "fault" else Phase.DONE, self._ending.reason
        )
        beacon().unwatch()
        self.record("", MissionEnded(self._ending.outcome, self._ending.reason))
        return self._ending

    def follow_past(self, resumption: Resumption) -> None:
        """Bring the tree to where a run that was cut off was; nothing is commanded.

        Raises:
            DataError: If the tree does something else than it did.
        """
        self.memory.history, now = resumption.history, self.clock
        self.clock = PastClock(resumption.history)
        resumption.follow(self.root, self.memory)
        self.clock = now

    def go_on_at(self, instant: Instant, event: Event) -> None:
        """Let the mission's time go on, and journal it."""
        self._tick = instant.tick
        self.clock.go_on_at(instant.tick, self._setup.tick_s, instant.mission_s)
        self.journal.append(self._tick, instant.mission_s, "", event)

    def _observe_anew(self, after_tick: Callable[["Mission"], None]) -> None:
        """Look at the world before anything moves; the time that takes counts against no limit."""
        began_s = self.clock.now_s()
        try:
            for _ in Observation(self.services).steps():
                self._end_tick()
                after_tick(self)
                self._read()
                self._follow_requests()
                if self._ending is not None:
                    return
        except Exception as error:  # whatever escapes a plugin
            self._fault(fault_of(error, self.services.plugins))
        self.asked_s += self.clock.now_s() - began_s
        self._ticked_s = self.clock.now_s()

    def _guarded_tick(self) -> None:
        try:
            self.injector.step()
            self._read()
            self._follow_requests()
            self._heed(self.guard.step())
            if self.phase in (Phase.RUNNING, Phase.AWAITING_OPERATOR):
                self._tick_tree()
        except MissionFaultError:
            pass  # the fault is recorded, and the machine was told to stop
        except Exception as error:  # any other error stops the machine, too
            self._fault(fault_of(error, self.services.plugins))
        self._end_tick()

    def _read(self) -> None:
        started_s = wall_s()
        observations = self._robot.read(self.clock.now_s())
        read_s = wall_s()
        if self._setup.recorder is not None:
            self._setup.recorder.write(observations, self.clock.now_s())
        if any(isinstance(one, JointSample) for one in observations):
            beacon().see_joints()
        self.services.streams.process(observations)
        durations = self._setup.jobs.durations_ms
        durations.setdefault("robot.read", []).append(1e3 * (read_s - started_s))
        durations.setdefault("streams", []).append(1e3 * (wall_s() - read_s))

    def _tick_tree(self) -> None:
        now_s = self.clock.now_s()
        if self.phase is Phase.AWAITING_OPERATOR:
            self.asked_s += now_s - self._ticked_s
        self._ticked_s = now_s
        self.memory.begin_tick(self._tick)
        self.root.tick_once()
        open_questions = [q for q in self._questions if q.answer() is None]
        self._questions = open_questions
        wanted = Phase.AWAITING_OPERATOR if open_questions else Phase.RUNNING
        if wanted != self.phase:
            self._change(wanted, "")
        if self._ending is None and self.root.status.value in ("SUCCESS", "FAILURE"):
            succeeded = self.root.status.value == "SUCCESS"
            self._ending = Ending(
                "success" if succeeded else "failure",
                "" if succeeded else self.root.feedback_message,
            )
        if self._ending is None and self.limited_time_s() >= self._setup.time_limit_s:
            self._ending = Ending(
                "failure", f"the time limit of {self._setup.time_limit_s:.0f} s has passed"
            )

    def _follow_requests(self) -> None:
        if self._stop_requested:
            self._ending = Ending("stopped", "stopped by the operator")
        elif self._pause_requested and self.phase != Phase.PAUSED:
            self._robot.stop()
            self._change(Phase.PAUSED, "paused by the operator")
        elif not self._pause_requested and self.phase == Phase.PAUSED:
            self._robot.resume()
            self._change(Phase.RUNNING, "resumed by the operator")

    def _heed(self, decision: Decision) -> None:
        """Do what a watched condition asks for."""
        if self._ending is not None or self.phase is Phase.PAUSED:
            return
        if decision.wish is Wish.STOP:
            self._fault(failure_of(decision))
        elif decision.wish is Wish.HOLD and self.phase is not Phase.HELD:
            self._before_hold = (
                self.clock.now_s(),
                self.services.streams.state(),
                self.guard.is_following,
            )
            self._robot.stop()
            self.record("", MissionHeld(decision.condition, decision.reason))
            self._change(Phase.HELD, decision.reason)
        elif decision.wish is Wish.GO_ON and self.phase is Phase.HELD:
            self._go_on(decision)

    def _go_on(self, decision: Decision) -> None:
        """End a hold; a path that was stopped for it is followed to its end."""
        now = self.services.streams.state()
        since_s, before, was_following = self._before_hold or (self.clock.now_s(), now, False)
        moved = inverse(before.T_map_cabin) @ now.T_map_cabin
        self.record(
            "",
            MissionWentOn(
                held_s=round(self.clock.now_s() - since_s, 6),
                reason=decision.reason,
                moved_m=float(np.linalg.norm(moved[:3, 3])),
                turned_rad=float(np.linalg.norm(log_so3(moved[:3, :3]))),
            ),
        )
        if was_following:
            self._robot.resume()
        self._change(Phase.RUNNING, decision.reason)

    def _come_to_rest(self, after_tick: Callable[["Mission"], None]) -> None:
        try:
            self._robot.stop()
            limit_s, rest = self.clock.now_s() + _STOP_LIMIT_S, Rest()
            while not self._stands(rest):
                if self.clock.now_s() >= limit_s:
                    raise MachineMovesError(
                        f"the machine still moves {_STOP_LIMIT_S:.0f} s after the stop"
                    )
                self._read()
                self._end_tick()
                after_tick(self)
        except MachineMovesError as error:
            self._ending = Ending("fault", str(error))
        except Exception as error:  # whatever escaped while the machine came to rest
            self._fault(fault_of(error, self.services.plugins))

    def _fault(self, fault: Fault) -> None:
        """Stop the machine for an error that escaped, and end the mission; the first one counts."""
        self._log(fault)
        self.record(fault.node, Faulted(fault))
        if not self.is_faulted:
            self.is_faulted = True
            self._ending = Ending("fault", fault.summary, fault)
        try:
            self._robot.stop()
        except Exception as error:  # recorded, and the mission ends all the same
            self.record("", StopFailed(f"{type(error).__name__}: {error}"))

    def _log(self, fault: Fault) -> None:
        logging.getLogger(__name__).error("%s\n%s", fault.summary, fault.traceback)

    def _stands(self, rest: Rest) -> bool:
        sample = self.services.streams.joints
        return sample is None or rest.add(self.clock.now_s(), sample.position, sample.velocity)

    def _end_tick(self) -> None:
        beacon().beat()
        while self._setup.jobs.told:
            self.record("", self._setup.jobs.told.popleft())
        state = self.services.streams.state()
        if state.is_ready and self._is_due(_STATE_PERIOD_S):
            self.states.append(state)
        if self._display.is_on and self._is_due(_VIEW_PERIOD_S):
            self.show("tree", {node.path: node.status for node in node_states(self.root)})
            self.show("state", state)
            if self.services.streams.joints is not None:
                self.show("joints", self.services.streams.joints)
        self._tick += 1
        self.clock.advance(self._setup.tick_s)
        self._keep()

    def _keep(self) -> None:
        """Write what a resumed run needs of the plugins."""
        now_s = self.clock.now_s()
        leaf_ended, self.memory.has_answered = self.memory.has_answered, False
        self._setup.keeper.keep(Instant(self._tick, now_s, now_s), leaf_ended=leaf_ended)

    def _is_due(self, period_s: float) -> bool:
        return self._tick % max(1, round(period_s / self._setup.tick_s)) == 0

    def take_verdict(self, verdict: Verdict) -> None:
        self.services.verdicts.append(verdict)
        self.show("verdict", verdict)
        self.record("", VerdictGiven(verdict.monitor, verdict.trouble, verdict.detail))

    def take_status(self, change: StatusChange) -> None:
        self.show("estimator", change)
        event = EstimatorStatusChanged(change.before, change.after, change.stamp_s, change.reason)
        self.record("", event)

    def take_error(self, capability: str, plugin: Plugin, error: Exception) -> None:
        """Take an error of a stream plugin: it is used no more, or ends the mission."""
        fault = fault_of(error, self.services.plugins)
        if (fault.capability, fault.name) not in self._setup.can_fail:
            raise error
        self._log(fault)
        self.record("", PluginFailed(fault))

    def take_unknown(self, kind: str) -> None:
        self.record("", ObservationIgnored(kind))

    def _change(self, phase: Phase, reason: str) -> None:
        self.record("", PhaseChanged(self.phase, phase, reason))
        self.phase = checked_change(self.phase, phase)
