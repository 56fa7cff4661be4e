"""What the report of a run says, gathered from the account, the plugins and the mission."""

import logging
from dataclasses import dataclass, field

from executive.errors import DataError
from executive.interfaces.report import MissionReport
from executive.interfaces.truth import Truth
from executive.mission.assembly import Selections
from executive.mission.compiling import Compiling
from executive.mission.machine_folder import MachineFolder
from executive.mission.mission import Mission
from executive.mission.record.samples import Samples
from executive.mission.report import Ending, cpu_s, resources_since, timings_from
from executive.mission.selections import is_judged, model_of
from executive.mission.setup import Setup
from executive.mission.truth import truth_of, witness_of
from executive.tree.language import MissionFile


@dataclass(slots=True)
class RunReport:
    """Gathers the report of one run.

    Attributes:
        description: The mission.
        selections: The plugins that the run has.
        setup: What the run is made of; its account holds what came of it.
        begun_cpu_s: Processor time of the process when the run began [s].
        compiling: What compiling takes since then.
    """

    description: MissionFile
    selections: Selections
    setup: Setup
    begun_cpu_s: float
    compiling: Compiling
    _truth: Truth | None = field(default=None, init=False)

    def of(self, ending: Ending, took_s: float, mission: Mission | None) -> MissionReport:
        """Return the report, as far as the mission came.

        Args:
            ending: How the run ended.
            took_s: Duration on the wall clock [s].
            mission: The mission; None if it could not begin.
        """
        account, ended_s = self.setup.account, self.setup.account.ended_s
        findings = account.findings
        guard = None if mission is None else mission.guard
        at_work_s = took_s - (0.0 if mission is None else mission.pause.wall_s)
        return MissionReport(
            mission=self.description.name,
            seed=self.setup.seed,
            outcome=ending.outcome,
            reason=ending.reason,
            fault=ending.fault,
            started_s=0.0,
            ended_s=ended_s,
            wall_s=round(took_s, 3),
            real_time_factor=round(ended_s / max(at_work_s, 1e-3), 3),
            picks=tuple(pick.as_report() for pick in account.picks()),
            plugins={
                key: tuple(one.name for one in several) for key, several in self.selections.items()
            },
            counts=account.counts(),
            figures=findings.figures,
            marks=findings.marks,
            stones=findings.stones,
            maps=findings.maps,
            structures=findings.structures,
            ignored_observations={} if mission is None else dict(mission.services.streams.ignored),
            refused_observations=None if guard is None else dict(guard.refused),
            missing_samples=None if guard is None else guard.missing(),
            scans_not_fused=0 if guard is None else guard.scans_not_fused,
            stale_states=0 if guard is None else guard.stale_states,
            faults=() if mission is None else mission.injector.report(),
            pauses=None if mission is None else mission.pause.as_report(),
            late_ticks=None if mission is None else mission.late_ticks.as_report(),
            resources=resources_since(self.begun_cpu_s, self.compiling.spent_s),
            timings_ms=timings_from(self._durations_ms(mission)),
            truth=self._truth,
        )

    def ask_oracle(self, mission: Mission | None) -> None:
        """Ask what really happened; `of` then reports it. A robot without an oracle has nothing.

        What that takes is no part of what the run took.
        """
        before_s = cpu_s()
        self._truth = self._true(mission)
        self.begun_cpu_s += cpu_s() - before_s

    def _true(self, mission: Mission | None) -> Truth | None:
        if mission is None or not is_judged(self.description):
            return None
        name, picks = self.description.plugins["robot"][0].name, self.setup.account.picks()
        ends = self.setup.account.findings.structures
        built = [one.shape for one in ends if one.shape is not None]
        judge = self.description.loop.structure_judge
        robot, machine = mission.services.plugins["robot"], self.setup.machine
        if machine is None:
            return truth_of(robot, name, mission, picks, built, judge)
        zero_s, path = robot.zero_s(), MachineFolder(self.setup.folder).truth
        machine.end()
        plugins, model = self.description.plugins, model_of(self.description)
        try:
            with witness_of(plugins, model, self.setup.seed, path, zero_s) as witness:
                return truth_of(witness, name, mission, picks, built, judge)
        except DataError as error:  # the machine's process was killed: nobody knows what happened
            logging.getLogger(__name__).warning("the report has no truth: %s", error)
            return None

    def _durations_ms(self, mission: Mission | None) -> dict[str, Samples[float]]:
        durations = dict(self.setup.jobs.durations_ms)
        return durations if mission is None else durations | mission.services.streams.durations_ms
