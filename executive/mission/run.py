"""One run from description to report."""

import logging
from collections.abc import Callable
from dataclasses import dataclass, replace

from executive.clock import SimulatedClock, WallClock, wall_s
from executive.clouds.ply_writer import write_ply
from executive.errors import ConfigError, DataError, RobotError
from executive.events.event import Event
from executive.events.mission import Faulted, MissionEnded
from executive.interfaces.report import MissionReport
from executive.interfaces.report_file import write_report
from executive.journal import Journal
from executive.journal.value_folder import ValueFolder
from executive.logs.recorder import Recorder
from executive.mission.compiling import Compiling
from executive.mission.control.listening import controlled
from executive.mission.fault import fault_of
from executive.mission.garbage import left_alone
from executive.mission.groot.watching import publisher_at, shown_to_groot
from executive.mission.guard import GuardSettings
from executive.mission.interrupts import stop_on_interrupt
from executive.mission.jobs.choice import Choice
from executive.mission.machine_folder import MachineFolder
from executive.mission.machine_process import (
    MachineProcess,
    behind_the_wire,
    lives_apart,
    silence_of,
)
from executive.mission.mission import Mission
from executive.mission.operator import Operator
from executive.mission.options import Options
from executive.mission.phase import Phase
from executive.mission.record.account import Account
from executive.mission.record.keeper import Keeper
from executive.mission.record.leaf_memory import LeafMemory
from executive.mission.record.resumption import Resumption
from executive.mission.report import Ending, cpu_s, summary
from executive.mission.run_folder import RunFolder
from executive.mission.run_log import run_log
from executive.mission.run_report import RunReport
from executive.mission.selections import (
    assembled,
    can_fail,
    is_judged,
    model_of,
    selections_of,
    verifies,
)
from executive.mission.setup import Setup
from executive.mission.stop_signals import Aborted, stop_after_report, stop_at_once, stopping
from executive.supervision.beacon import beacon
from executive.tree.build import build_tree, halt
from executive.tree.language import MissionFile
from executive.tree.resolved import resolved_yaml


@dataclass(frozen=True, slots=True)
class Result:
    """What a run leaves to its caller."""

    report: MissionReport
    folder: RunFolder
    exit_status: int

    @property
    def summary(self) -> str:
        """Say in a few lines what came of it."""
        return summary(self.report)


class Run:
    """One run of a checked mission; whatever happens, its folder holds what there is."""

    def __init__(
        self, description: MissionFile, options: Options, resumption: Resumption | None = None
    ) -> None:
        """Make the plugins and the folder; nothing moves yet.

        Args:
            description: The mission.
            options: How it is run.
            resumption: The run that was cut off and is to go on.

        Raises:
            ConfigError: If the folder, the machine's model or a plugin's settings are refused.
        """
        self._description = description
        self._options = options
        self._selections = selections_of(description, options.seen_by)
        self._model = model_of(description)
        self._machine: MachineProcess | None = None
        if options.real_time and options.apart and lives_apart(description):
            self._machine = MachineProcess(options.seed, silence_of(description))
            driven = behind_the_wire(description, self._machine.address)
            self._selections = selections_of(driven, options.seen_by)
        self._assembly = assembled(self._selections, self._model, options.seed)
        self._groot = publisher_at(options.groot)
        self._resumption = resumption
        self.folder = self._new_folder() if resumption is None else resumption.folder
        self._account = Account(verifies=verifies(description))
        self._journal = Journal(self.folder.journal)
        if resumption is not None:
            resumption.write_after(self._journal, self._account)
        self._journal.follow(self._account.add)
        self._setup = self._made_setup()
        self._tell: Callable[[str], None] = lambda text: None
        self._mission: Mission | None = None
        self._is_closed = False

    def _new_folder(self) -> RunFolder:
        """Make the folder, with what is needed to run the mission again or to resume it."""
        folder = RunFolder.create(self._options.run_dir, self._description.name)
        folder.mission.write_text(resolved_yaml(self._description), encoding="utf-8")
        self._options.kept.write(folder.options)
        return folder

    def _made_setup(self) -> Setup:
        """Make what the mission's loop works with, from the plugins and what the file says."""
        description, options, loop = self._description, self._options, self._description.loop
        values = ValueFolder(self.folder.values)
        clock = WallClock() if options.real_time else SimulatedClock()
        choice = Choice(self._assembly.plugins, self._selections, self._model, options.seed)
        return Setup(
            clock=clock,
            tick_s=loop.tick,
            time_limit_s=loop.time_limit,
            seed=options.seed,
            assembly=self._assembly,
            jobs=choice.make(loop, clock, options.runner, is_lock_step=not options.real_time),
            journal=self._journal,
            account=self._account,
            operator=Operator(options.answer, chosen=options.choices, is_attended=options.attended),
            memory=LeafMemory(values, lambda: self._secure(values)),
            keeper=Keeper(self.folder.kept, self._assembly.plugins, beside=options.real_time),
            folder=self.folder.path,
            recorder=self._recorder(),
            regions=description.regions,
            can_fail=can_fail(description),
            guard=GuardSettings(
                description.faults,
                description.watch,
                has_judge=self._machine is not None and is_judged(description),
            ),
            machine=self._machine,
            heartbeat_limit_s=loop.heartbeat_limit if options.real_time else 0.0,
            late_ticks=loop.late_ticks,
        )

    def execute(
        self, after_tick: Callable[[Mission], None], tell: Callable[[str], None] = lambda text: None
    ) -> Result:
        """Run to the end and write the report.

        Args:
            after_tick: Called after each tick.
            tell: Called with what a person should know before the mission begins.

        Raises:
            ConfigError: If a plugin cannot start with its settings; nothing has moved then.
            DataError: If a file that a plugin needs is missing or wrong; nothing has moved then.
        """
        self._tell = tell
        started_s, compiling = wall_s(), Compiling(self._tell_compiling)
        made = RunReport(self._description, self._selections, self._setup, cpu_s(), compiling)
        beacon().name(
            run_dir=str(self.folder.path.absolute()),
            mission=self._description.name,
            machine=self._assembly.plugins["robot"].address(),
        )
        with stopping(stop_after_report), run_log(self.folder.log), compiling.watching():
            try:
                ending = self._run(after_tick)
                wall = wall_s() - started_s
                self._end_journal(ending)
                self.folder.give_room()
                write_report(self.folder.report, made.of(ending, wall, self._mission))
                ending = self._afterwards(ending, self._save_map)
                ending = self._afterwards(ending, lambda: made.ask_oracle(self._mission))
                ending = self._afterwards(ending, self._close)
                report = made.of(ending, wall, self._mission)
                write_report(self.folder.report, report)
                if self._account.has_ended:
                    self.folder.forget_state()
            except OSError as error:
                raise RobotError(
                    f"the report cannot be written into {self.folder.path}: {error.strerror}; the "
                    "machine was brought to a safe stop"
                ) from error
            finally:
                if self._setup.recorder is not None:
                    self._setup.recorder.close()
                self._close_after_error()
                self._setup.keeper.close()
                self._journal.close()
                self.folder.release()
        return Result(report, self.folder, ending.exit_status)

    def _run(self, after_tick: Callable[[Mission], None]) -> Ending:
        try:
            with stopping(stop_at_once):
                return self._started(after_tick)
        except Aborted as error:
            return Ending("stopped", str(error))

    def _tell_compiling(self, text: str) -> None:
        """Say so before the loop, which is when all but a few functions are compiled; then log."""
        if self._mission is None:
            self._tell(text)
        else:
            logging.getLogger(__name__).info(text)

    def _end_journal(self, ending: Ending) -> None:
        """Write the end record, unless the mission did, or a run may still be resumed."""
        begun = self._mission is not None and self._mission.phase is not Phase.IDLE
        if not self._account.has_ended and (begun or self._resumption is None):
            self._append(MissionEnded(ending.outcome, ending.reason))

    def _started(self, after_tick: Callable[[Mission], None]) -> Ending:
        try:
            self._start()
        except (ConfigError, DataError):  # wrong settings or files; nothing has moved
            raise
        except Exception as error:  # an error of a plugin before the loop
            return self._faulted(error)
        try:
            self._mission = Mission(
                self._setup, lambda runtime: build_tree(self._description, runtime), halt
            )
            if self._resumption is not None:
                self._resume(self._resumption, self._mission)
            self._mission.wishes.pause_on_failure = self._options.pause_on_failure
            with (
                stop_on_interrupt(self._mission),
                controlled(self._mission, self.folder.path.absolute()),
                shown_to_groot(self._description, self._mission, self._groot),
                left_alone(self._options.real_time),
            ):
                return self._mission.run(after_tick)
        except DataError as error:
            if self._resumption is None:
                return self._faulted(error)
            raise  # the past cannot be followed; nothing has moved
        except Exception as error:  # an error that escaped the loop itself
            return self._faulted(error)

    def _resume(self, resumption: Resumption, mission: Mission) -> None:
        """Bring plugins and tree to where the run was cut off.

        Raises:
            DataError: If the journal cannot be followed; nothing has moved then.
        """
        mission.follow_past(resumption)
        kept, restored, lost = self._setup.keeper.restore()
        instant = resumption.instant(kept, self._setup.tick_s)
        robot = self._assembly.plugins["robot"]
        instant = replace(instant, machine_s=robot.taken_up_s(instant.machine_s))
        mission.go_on_at(instant, resumption.event(restored, lost))

    def _secure(self, values: ValueFolder) -> None:
        values.secure()
        self._journal.secure()

    def _start(self) -> None:
        if self._machine is not None:
            self._machine.start(MachineFolder(self.folder.path.absolute()))
        self._assembly.start()
        plugins = self._assembly.plugins
        if "objects" in plugins:
            plugins["objects"].open(str(self.folder.objects))
        if self._options.record:
            plugins["viewing"].open(str(self.folder.recording))
        if self._options.live is not None:
            self._tell(
                f"the mission is shown in {plugins['viewing'].show_live(self._options.live)}"
            )
        self._setup.jobs.prepare()

    def _close(self) -> None:
        """Close jobs and then plugins, once: a job that still runs uses its plugin."""
        if not self._is_closed:
            self._is_closed = True
            self._setup.jobs.close()
            try:
                self._setup.keeper.settle()
            finally:
                self._assembly.close()
            if self._machine is not None:
                self._machine.end()

    def _close_after_error(self) -> None:
        """Close what an error left open; that error is reported, and one of closing is logged."""
        try:
            self._close()
        except Exception:  # must not replace the error that is on its way
            logging.getLogger(__name__).exception("a plugin failed while it was closed")

    def _afterwards(self, ending: Ending, step: Callable[[], None]) -> Ending:
        """Do a step after the loop; an error of a plugin there is a fault, and loses nothing."""
        try:
            step()
        except Exception as error:  # whatever escapes a plugin
            fault = self._faulted(error)
            return ending if ending.is_fault else fault
        return ending

    def _faulted(self, error: Exception) -> Ending:
        fault = fault_of(error, self._assembly.plugins)
        logging.getLogger(__name__).error("%s\n%s", fault.summary, fault.traceback)
        self._append(Faulted(fault))
        return Ending("fault", fault.summary, fault)

    def _append(self, event: Event) -> None:
        last = self._account.last
        self._journal.append(last.tick if last else 0, self._account.ended_s, "", event)

    def _recorder(self) -> Recorder | None:
        path = self._options.record_log
        return None if path is None else Recorder(path, self._assembly.machine, self._model)

    def _save_map(self) -> None:
        if self._mission is not None and "mapping" in self._assembly.plugins:
            self._mission.services.streams.settle()
            cloud = self._assembly.plugins["mapping"].cloud()
            write_ply(self.folder.map, cloud.points, cloud.frame)
