"""A running mission: the tick loop, and what the nodes of the tree see of it."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from executive.clock import wall_s
from executive.events.event import Event
from executive.events.mission import (
    Fault,
    Faulted,
    MissionEnded,
    PauseEnded,
    PhaseChanged,
    StopFailed,
)
from executive.events.site import RegionNamed
from executive.events.watch import MissionHeld
from executive.faults.injector import Injector
from executive.interfaces.robot import Robot
from executive.leaf.runtime import MissionFaultError, Question, Runtime
from executive.leaf.store import Store
from executive.machine.kinematics import Kinematics
from executive.messages.base_state import BaseState
from executive.messages.cloud import Cloud
from executive.messages.joints import JointSample
from executive.messages.stone import Stone
from executive.mission.braking import Braking
from executive.mission.context import NodeContext, Services
from executive.mission.display import Display
from executive.mission.guard import Guard, failure_of
from executive.mission.hold import Hold
from executive.mission.late_ticks import LateTicks
from executive.mission.pause import Pause
from executive.mission.phase import Phase, checked_change
from executive.mission.plugin_errors import PluginErrors, log
from executive.mission.record.keeper import Instant
from executive.mission.record.leaf_memory import LeafMemory
from executive.mission.record.observation import Observation
from executive.mission.record.resumption import PastClock, Resumption
from executive.mission.report import Ending
from executive.mission.setup import Setup
from executive.mission.standstill import Standstill
from executive.mission.stream_events import StreamEvents
from executive.mission.streams import Streams
from executive.supervision.beacon import beacon
from executive.watch.watch import Decision, Wish

_STATE_PERIOD_S = 1.0  # of the estimates kept for the report
_VIEW_PERIOD_S = 0.2  # of poses and tree states handed to the viewer
_STOPPED = Ending("stopped", "stopped by the operator")


class Mission(Runtime):
    """The tick loop: read → streams → tree → commands → journal, viewer."""

    def __init__(
        self, setup: Setup, build: Callable[[Runtime], Any], halt: Callable[[Any], None]
    ) -> None:
        self.clock = setup.clock
        self.clock.start()
        self.store = Store()
        self.phase = Phase.IDLE
        self.states: list[BaseState] = []
        # For the report's truth: each stone as it was first shown, and the newest survey.
        self.first_stones: dict[int, Stone] = {}
        self.survey: Cloud | None = None
        self._setup = setup
        self.journal = setup.journal
        self.account = setup.account
        self._tick = 0  # of the mission: it stands still in a pause
        self._ending: Ending | None = None
        self._stop_requested = False
        self._pause_requested = False
        self._questions: list[Question] = []
        self._loops = 0  # as the ticks of the mission, and in a pause as well
        plugins, machine = setup.assembly.plugins, setup.assembly.machine
        self._robot: Robot = plugins["robot"]
        self._errors = PluginErrors(plugins, setup.can_fail, self.record)
        events = StreamEvents(self.record, self.show, self._errors)
        self._display = Display(
            plugins.get("viewing"),
            setup.clock,
            lambda viewer, error: events.take_error("viewing", viewer, error),
        )
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
            plugins=plugins,
            jobs=setup.jobs,
            streams=Streams(plugins, lidars, events, self.guard),
            account=self.account,
            journal=setup.journal,
            folder=setup.folder,
            record=self.record,
            show=self.show,
            regions=setup.regions,
            verdicts=events.verdicts,
        )
        self.guard.bind(self.services.streams)
        self._hold: Hold | None = None
        self.pause = Pause(setup.clock, plugins, events.take_error)
        self.late_ticks = LateTicks(setup.tick_s, setup.late_ticks, machine)
        self._braking = Braking(setup.clock, machine, self.record)
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

    def let_go(self, node: str, parts: tuple[str, ...]) -> None:
        self._braking.add(node, parts, self.services.streams.joints)

    def still_driven(self, parts: tuple[str, ...]) -> str:
        return self._braking.awaited(parts)

    def fail(self, error: Exception, node: str, leaf: str) -> str:
        if isinstance(error, MissionFaultError):
            raise error
        fault = self._errors.fault_of(error, node, leaf)
        if self._errors.excuses(fault):
            return fault.summary
        self._fault(fault)
        raise MissionFaultError(fault.summary) from error

    # --- what people do

    def request_stop(self) -> None:
        """Stop along the path as soon as the tick allows it, then end."""
        self._stop_requested = True
        self.clock.wake()

    def toggle_pause(self) -> None:
        """Pause as soon as the tick allows it, or go on."""
        self._pause_requested = not self._pause_requested
        self.clock.wake()

    def time_report(self) -> dict[str, Any]:
        """Return what the report says of pauses and of late ticks."""
        return {"pauses": self.pause.as_report(), "late_ticks": self.late_ticks.as_report()}

    # --- the loop

    def run(self, after_tick: Callable[["Mission"], None]) -> Ending:
        """Tick until the tree has ended or the mission is stopped; the machine is then at rest."""
        self._change(Phase.RUNNING, "")
        self._show_regions()
        try:
            if self.memory.history is not None:
                self._observe_anew(after_tick)
            while self._ending is None:
                self._guarded_tick()
                after_tick(self)
        except BaseException:  # the operator ends it at once, or the loop itself failed
            self._safe_stop("the run was ended at once")
            raise
        finally:
            self._halt(self.root)  # a leaf's clean-up needs the robot
        self.pause.leave()
        if self._ending.outcome == "fault":
            self._await_rest_after_fault(self._ending.fault)
            self._change(Phase.FAULTED, self._ending.reason)
        else:
            self._change(Phase.STOPPING, self._ending.reason)
            self._come_to_rest(after_tick)
            is_fault = self._ending.outcome == "fault"
            self._change(Phase.FAULTED if is_fault else Phase.DONE, self._ending.reason)
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
        self.clock.go_on_at(instant.tick, self._setup.tick_s, instant.mission_s, instant.machine_s)
        self.journal.append(self._tick, instant.mission_s, "", event)

    def _observe_anew(self, after_tick: Callable[["Mission"], None]) -> None:
        """Look at the world before anything moves; the time that takes counts against no limit."""
        began_s = self.clock.now_s()
        try:
            for _ in Observation(self.services).steps():
                self._end_tick()
                after_tick(self)
                self._read()
                self._follow_stop()
                if self._ending is not None:
                    return
        except Exception as error:  # whatever escapes a plugin
            self._fault(self._errors.fault_of(error))
        self.uncounted_s += self.clock.now_s() - began_s

    def _guarded_tick(self) -> None:
        try:
            self._follow_stop()
            if not self._is_still:
                self.injector.step()
                self._read()
                self._heed(self.guard.step())
            self._follow_pauses()
            if self._ending is None and self.phase is Phase.RUNNING:
                self.late_ticks.check()
                self._tick_tree()
                self._follow_stop()
                self._follow_pauses()
        except MissionFaultError:
            pass  # the fault is recorded, and the machine was told to stop
        except Exception as error:  # any other error stops the machine, too
            self._fault(self._errors.fault_of(error))
        self._end_tick()

    def _read(self) -> None:
        started_s, now_s = wall_s(), self.clock.machine_s()
        observations = self._robot.read(now_s)
        read_s = wall_s()
        if self._setup.recorder is not None:
            self._setup.recorder.write(observations, now_s)
        if any(isinstance(one, JointSample) for one in observations):
            beacon().see_joints()
        self._follow_stop()
        self.services.streams.process(observations)
        durations = self._setup.jobs.durations_ms
        durations.setdefault("robot.read", []).append(1e3 * (read_s - started_s))
        durations.setdefault("streams", []).append(1e3 * (wall_s() - read_s))
        self.pause.watch(self.services.streams.joints)
        self._braking.update(self.services.streams.joints)
        self._follow_stop()

    def _tick_tree(self) -> None:
        self.memory.begin_tick(self._tick)
        self.root.tick_once()
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

    def _follow_stop(self) -> None:
        """Tell the machine to stop once the operator wants it; that outranks how the tree ended."""
        if not self._stop_requested or (self._ending and self._ending.outcome != "success"):
            return
        self._ending = _STOPPED
        self._robot.stop()

    def _heed(self, decision: Decision) -> None:
        """Do what a watched condition asks for."""
        if self._ending is not None or self.phase is Phase.PAUSED:
            return
        now_s, state = self.clock.machine_s(), self.services.streams.state()
        if decision.wish is Wish.STOP:
            self._fault(failure_of(decision))
        elif decision.wish is Wish.HOLD and self._hold is None:
            self._hold = Hold(decision.reason, now_s, state)
            self.record("", MissionHeld(decision.condition, decision.reason))
        elif decision.wish is Wish.GO_ON and self._hold is not None:
            self.record("", self._hold.ended(now_s, state, decision.reason))
            self._hold = None

    def _follow_pauses(self) -> None:
        """Hold the mission, or let it go on, as the operator wants and open questions demand."""
        self._questions = [one for one in self._questions if one.answer() is None]
        wanted, reason = Phase.RUNNING, ""
        if self._questions:
            wanted = Phase.AWAITING_OPERATOR
        if self._hold is not None:
            wanted, reason = Phase.HELD, self._hold.reason
        if self._pause_requested:
            wanted, reason = Phase.PAUSED, "paused by the operator"
        if self._ending is not None or wanted is self.phase:
            return
        if wanted is Phase.RUNNING:
            reason = "resumed by the operator" if self.phase is Phase.PAUSED else ""
            self.record("", PauseEnded(round(self.pause.end(), 6)))
        elif not self.pause.is_on:
            self.pause.begin()
        self._change(wanted, reason)

    # --- the stop

    def _come_to_rest(self, after_tick: Callable[["Mission"], None]) -> None:
        try:
            self._robot.stop()
            standstill = Standstill(self.clock, self.services.machine)
            while not standstill.reached(self.services.streams.joints):
                self._read()
                self._end_tick()
                after_tick(self)
        except Exception as error:  # whatever escaped while the machine came to rest
            self._fault(self._errors.fault_of(error))

    def _await_rest_after_fault(self, fault: Fault | None) -> None:
        """Look at the joints alone until they stand: a plugin that failed is asked no more."""
        if fault is not None and fault.capability == "robot":
            return  # it was told to stop, and there is nobody to ask
        try:
            sample, tick_s = self.services.streams.joints, self._setup.tick_s
            standstill = Standstill(self.clock, self.services.machine)
            self._tick += standstill.await_alone(self._robot, sample, tick_s)
        except Exception as error:  # the mission has ended in a fault: this is told beside it
            self.record("", StopFailed(f"{type(error).__name__}: {error}"))

    def _safe_stop(self, reason: str) -> None:
        """Latch the machine's safe stop; an error of it is recorded, and nothing is lost by it."""
        try:
            self._robot.safe_stop(reason)
        except Exception as error:  # recorded, and the mission ends all the same
            self.record("", StopFailed(f"{type(error).__name__}: {error}"))

    def _fault(self, fault: Fault) -> None:
        """Stop the machine for an error that escaped, and end the mission; the first one counts."""
        log(fault)
        self.record(fault.node, Faulted(fault))
        if not self.is_faulted:
            self.is_faulted = True
            self._ending = Ending("fault", fault.summary, fault)
        self._safe_stop(fault.summary)

    # --- the end of a tick

    def _end_tick(self) -> None:
        beacon().beat()
        while self._setup.jobs.told:
            self.record("", self._setup.jobs.told.popleft())
        state = self.services.streams.state()
        if state.is_ready and not self.pause.is_on and self._is_due(_STATE_PERIOD_S):
            self.states.append(state)
        if self._display.is_on and self._is_due(_VIEW_PERIOD_S):
            self._display.show_machine(self.root, state, self.services.streams.joints)
        if self._is_still:
            self.clock.idle()
            return
        late = self.late_ticks.add(self.clock.advance(self._setup.tick_s))
        if late is not None:
            self.record("", late)
        self._loops += 1
        if not self.pause.is_on:
            self._tick += 1
        self._keep()

    def _keep(self) -> None:
        """Write what a resumed run needs of the plugins."""
        instant = Instant(self._tick, self.clock.now_s(), self.clock.machine_s())
        leaf_ended, self.memory.has_answered = self.memory.has_answered, False
        self._setup.keeper.keep(instant, leaf_ended=leaf_ended)

    def _show_regions(self) -> None:
        for name, region in self.services.regions.items():
            self.record("", RegionNamed(name, region.corners_map))
            self.show(f"regions/{name}", region)

    @property
    def _is_still(self) -> bool:
        """Whether nothing goes on at all; in a hold, what is awaited needs time to come back."""
        return self.pause.is_still and self._hold is None

    def _is_due(self, period_s: float) -> bool:
        return self._loops % max(1, round(period_s / self._setup.tick_s)) == 0

    def _change(self, phase: Phase, reason: str) -> None:
        self.record("", PhaseChanged(self.phase, phase, reason))
        self.phase = checked_change(self.phase, phase)
