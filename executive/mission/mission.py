"""A running mission: the tick loop, what people ask of it, and how it ends."""

from collections.abc import Callable
from typing import Any

from executive.clock import wall_s
from executive.events.event import Event
from executive.events.mission import Fault, MissionEnded, PauseEnded, PhaseChanged, StopFailed
from executive.events.watch import MissionHeld
from executive.leaf.runtime import MissionFaultError, Runtime
from executive.messages.joints import JointSample
from executive.mission.guard import failure_of
from executive.mission.hold import Hold
from executive.mission.jobs.tick_call import observations_of
from executive.mission.late_ticks import LateTicks
from executive.mission.node_runtime import NodeRuntime
from executive.mission.observation import Observation
from executive.mission.pause import Pause
from executive.mission.phase import Phase, checked_change
from executive.mission.record.keeper import Instant, folder_fault
from executive.mission.record.resumption import PastClock, Resumption
from executive.mission.record.samples import Samples
from executive.mission.report import Ending
from executive.mission.setup import Setup
from executive.mission.standstill import Standstill, brake_s
from executive.supervision.beacon import beacon
from executive.supervision.child import abandon
from executive.watch.watch import Decision, Wish

_ORPHANED = "the supervisor, the first of the run's two processes, has ended"
_STATE_PERIOD_S = 1.0  # of the estimates kept for the report
_VIEW_PERIOD_S = 0.2  # of poses and tree states handed to the viewer


class Mission(NodeRuntime):
    """The tick loop: read → streams → tree → commands → journal, viewer."""

    def __init__(
        self, setup: Setup, build: Callable[[Runtime], Any], halt: Callable[[Any], None]
    ) -> None:
        super().__init__(setup)
        self.phase = Phase.IDLE
        plugins, machine = setup.assembly.plugins, setup.assembly.machine
        self._brake_s = brake_s(machine, plugins)
        self.pause = Pause(setup.clock, plugins, self._events.take_error, self._brake_s)
        self.late_ticks = LateTicks(setup.tick_s, setup.late_ticks, machine)
        self._hold: Hold | None = None
        self.phase_reason = ""
        # Called wherever the loop can follow what people ask, never within a tick of the tree.
        self.between: list[Callable[[], None]] = []
        self._loops = 0  # as the ticks of the mission, and in a pause as well
        self._halt = halt
        self.root = build(self)

    # --- what people do

    def request_stop(self) -> None:
        """Stop along the path as soon as the tick allows it, then end."""
        self.wishes.stop = True
        self.clock.wake()

    def be_orphaned(self) -> None:
        """Stop the machine as soon as the tick allows it, and leave the run to be resumed."""
        self.wishes.is_orphaned = True
        self.clock.wake()

    def toggle_pause(self) -> None:
        """Pause as soon as the tick allows it, or go on."""
        self.wishes.toggle()
        self.clock.wake()

    @property
    def is_held(self) -> bool:
        """Whether a watched condition is broken, and the mission waits for it."""
        return self._hold is not None

    # --- the loop

    def run(self, after_tick: Callable[["Mission"], None]) -> Ending:
        """Tick until the tree has ended or the mission is stopped; the machine is then at rest."""
        if self.memory.history is None:
            self.clock.start()  # to build the tree took some time, in which nobody read the robot
        self._change(Phase.RUNNING, "")
        self._name_regions()
        if self._setup.heartbeat_limit_s:
            limit_s = self._setup.heartbeat_limit_s
            beacon().watch(limit_s, limit_s + self._setup.tick_s)
        try:
            if self.memory.history is not None:
                self._observe_anew(after_tick)
            while self._ending is None:
                self._guarded_tick()
                self._after_tick(after_tick)
        except BaseException:  # the operator ends it at once, or the loop itself failed
            self._safe_stop("the run was ended at once")
            raise
        finally:
            self.memory.leave_past()
            self._halt(self.root)  # a leaf's clean-up needs the robot
        self.pause.leave()
        if self._ending.is_fault:
            self._await_rest_after_fault(self._ending.fault)
            self._change(Phase.FAULTED, self._ending.reason)
        else:
            self._change(Phase.STOPPING, self._ending.reason)
            self._come_to_rest(after_tick)
            self._follow_stop()
            self._change(
                Phase.FAULTED if self._ending.is_fault else Phase.DONE, self._ending.reason
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
        self.clock.go_on_at(instant.tick, self._setup.tick_s, instant.mission_s, instant.machine_s)
        self.journal.append(self._tick, instant.mission_s, "", event)

    def _observe_anew(self, after_tick: Callable[["Mission"], None]) -> None:
        """Look at the world before anything moves; the time that takes counts against no limit."""
        began_s = self.clock.now_s()
        try:
            for _ in Observation(self.services).steps():
                self._end_tick()
                self._after_tick(after_tick)
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
                read_s = self._read()
                with self.times.spent("watch"):
                    self._heed(self.guard.step(read_s))
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

    def _read(self) -> float:
        """Take what was measured, and return the machine time at which that was asked for [s]."""
        latest_s = self._robot.latest_s()
        self.clock.wait_for(latest_s)
        started_s, now_s = wall_s(), self.clock.machine_s()
        with self.times.spent("robot.read"):
            observations = observations_of(self._robot, now_s)
        read_s = wall_s()
        if self._setup.recorder is not None:
            with self.times.spent("recorder"):
                self._setup.recorder.write(observations, now_s)
        if any(isinstance(one, JointSample) for one in observations):
            beacon().see_joints()
        self._follow_stop()
        with self.times.spent("streams"):
            self.services.streams.process(observations)
        durations = self._setup.jobs.durations_ms
        durations.setdefault("robot.read", Samples()).append(1e3 * (read_s - started_s))
        durations.setdefault("streams", Samples()).append(1e3 * (wall_s() - read_s))
        self.pause.watch(self.services.streams.joints)
        self._braking.update(self.services.streams.joints)
        self._follow_stop()
        return min(now_s, latest_s)

    def _tick_tree(self) -> None:
        self.memory.begin_tick(self._tick)
        with self.times.spent("tree"):
            self.root.tick_once()
        self._cut = None  # where nothing moved the machine, the rule's wait is what is left
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
        with self.times.spent("control"):
            for follow in self.between:
                follow()
        if self.wishes.is_orphaned:
            self._safe_stop(_ORPHANED)
            self.journal.secure()
            abandon(f"{_ORPHANED}; the machine was told to stop, and the run can be resumed")
        if not self.wishes.stop or (self._ending and self._ending.outcome != "success"):
            return
        self._ending = Ending("stopped", "stopped by the operator")
        self._robot.stop()

    def _heed(self, decision: Decision) -> None:
        """Do what a watched condition asks for."""
        if self._ending is not None or self.phase is Phase.PAUSED:
            return
        now_s, state = self.clock.machine_s(), self.services.streams.state()
        if decision.wish is Wish.STOP:
            self._fault(failure_of(decision))
        elif decision.wish is Wish.FAIL:
            self._cut = decision
        elif decision.wish is Wish.HOLD and self._hold is None:
            self._hold = Hold(decision.reason, now_s, state)
            self.record("", MissionHeld(decision.condition, decision.reason))
        elif decision.wish is Wish.GO_ON and self._hold is not None:
            self.record("", self._hold.ended(now_s, state, decision.reason))
            self._hold = None

    def _follow_pauses(self) -> None:
        """Hold the mission, or let it go on, as the operator wants and open questions demand."""
        self.questions = [one for one in self.questions if one.question.answer() is None]
        wanted, reason = self.wishes.phase(self._hold, is_asking=bool(self.questions))
        is_over = wanted is Phase.RUNNING
        if self._ending is not None or self.pause.must_wait(is_over) or wanted is self.phase:
            return
        if is_over:
            reason = self.wishes.resumed if self.phase is Phase.PAUSED else ""
            self.record("", PauseEnded(round(self.pause.end(), 6)))
        elif not self.pause.is_on:
            self.pause.begin()
        self._change(wanted, reason)

    # --- the stop

    def _come_to_rest(self, after_tick: Callable[["Mission"], None]) -> None:
        try:
            self._robot.stop()
            standstill = Standstill(self.clock, self.services.machine, self._brake_s)
            while not standstill.reached(self.services.streams.joints):
                self._read()
                self._end_tick()
                self._after_tick(after_tick)
        except Exception as error:  # whatever escaped while the machine came to rest
            self._fault(self._errors.fault_of(error))

    def _await_rest_after_fault(self, fault: Fault | None) -> None:
        """Look at the joints alone until they stand: a plugin that failed is asked no more."""
        if fault is not None and fault.capability == "robot":
            return  # it was told to stop, and there is nobody to ask
        try:
            sample, tick_s = self.services.streams.joints, self._setup.tick_s
            standstill = Standstill(self.clock, self.services.machine, self._brake_s)
            self._tick += standstill.await_alone(self._robot, sample, tick_s)
        except Exception as error:  # the mission has ended in a fault: this is told beside it
            self.record("", StopFailed(f"{type(error).__name__}: {error}"))

    # --- the end of a tick

    def _after_tick(self, after_tick: Callable[["Mission"], None]) -> None:
        with self.times.spent("progress"):
            after_tick(self)

    def _end_tick(self) -> None:
        beacon().beat()
        while self._setup.jobs.told:
            self.record("", self._setup.jobs.told.popleft())
        state = self.services.streams.state()
        if state.is_ready and not self.pause.is_on and self._is_due(_STATE_PERIOD_S):
            self.guard.judge(state)
        if self._display.is_on and self._is_due(_VIEW_PERIOD_S):
            with self.times.spent("display"):
                self._display.show_machine(self.root, state, self.services.streams.joints)
        if self._is_still:
            self.clock.idle()
            self.times.start()
            return
        shares = self.times.shares()
        late = self.late_ticks.add(self.clock.advance(self._setup.tick_s), shares)
        self.times.start()
        if late is not None:
            self.record("", late)
        self._loops += 1
        if not self.pause.is_on:
            self._tick += 1
            self.wishes.ticked()
        self._keep()

    def _keep(self) -> None:
        """Write what a resumed run needs of the plugins."""
        instant = Instant(self._tick, self.clock.now_s(), self.clock.machine_s())
        leaf_ended, self.memory.has_answered = self.memory.has_answered, False
        failure = self.journal.failure or self.memory.failure or self._setup.keeper.failure
        if failure is not None:
            if self._ending is None:
                self._fault(folder_fault(failure))
            return
        with self.times.spent("keeping"):
            self._setup.keeper.keep(instant, leaf_ended=leaf_ended)

    @property
    def _is_still(self) -> bool:
        """Whether nothing goes on at all; in a hold, what is awaited needs time to come back."""
        return self.pause.is_still and self._hold is None

    def _is_due(self, period_s: float) -> bool:
        return self._loops % max(1, round(period_s / self._setup.tick_s)) == 0

    def _change(self, phase: Phase, reason: str) -> None:
        self.record("", PhaseChanged(self.phase, phase, reason))
        self.phase, self.phase_reason = checked_change(self.phase, phase), reason
