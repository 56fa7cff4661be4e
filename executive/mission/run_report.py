"""What the report of a run says, gathered from the account, the plugins and the mission."""

from dataclasses import dataclass
from typing import Any

from executive.mission.assembly import Selections
from executive.mission.mission import Mission
from executive.mission.report import Ending, resources_since, timings_from
from executive.mission.setup import Setup
from executive.mission.truth import truth_of
from executive.tree.language import MissionFile


@dataclass(frozen=True, slots=True)
class RunReport:
    """The report of one run.

    Attributes:
        description: The mission.
        selections: The plugins that the run has.
        setup: What the run is made of; its account holds what came of it.
        begun_cpu_s: Processor time of the process when the run began [s].
    """

    description: MissionFile
    selections: Selections
    setup: Setup
    begun_cpu_s: float

    def of(self, ending: Ending, took_s: float, mission: Mission | None) -> dict[str, Any]:
        """Return the report, as far as the mission came.

        Args:
            ending: How the run ended.
            took_s: Duration on the wall clock [s].
            mission: The mission; None if it could not begin.
        """
        account, ended_s = self.setup.account, self.setup.account.ended_s
        at_work_s = took_s - (0.0 if mission is None else mission.pause.wall_s)
        return {
            "mission": self.description.name,
            "seed": self.setup.seed,
            "outcome": ending.outcome,
            "reason": ending.reason,
            "fault": ending.fault,
            "started_s": 0.0,
            "ended_s": ended_s,
            "wall_s": round(took_s, 3),
            "real_time_factor": round(ended_s / max(at_work_s, 1e-3), 3),
            "picks": [pick.as_report() for pick in account.picks()],
            "plugins": {
                key: [one.name for one in several] for key, several in self.selections.items()
            },
            "counts": account.counts(),
            **account.findings.as_report(),
            **_observed(mission),
            "resources": resources_since(self.begun_cpu_s),
            "timings_ms": timings_from(self._durations_ms(mission)),
        }

    def truth(self, mission: Mission | None) -> dict[str, Any]:
        """Return what the robot's oracle says of the run; nothing if it has none."""
        if mission is None:
            return {}
        robot_name = self.description.plugins["robot"][0].name
        return truth_of(robot_name, mission, self.setup.account.picks())

    def _durations_ms(self, mission: Mission | None) -> dict[str, Any]:
        durations: dict[str, Any] = dict(self.setup.jobs.durations_ms)
        return durations if mission is None else durations | mission.services.streams.durations_ms


def _observed(mission: Mission | None) -> dict[str, Any]:
    """Return which observations were ignored or refused, what was injected, and the times."""
    if mission is None:
        return {"ignored_observations": {}}
    injected = mission.injector.report()
    return {
        "ignored_observations": dict(mission.services.streams.ignored),
        **mission.guard.report(),
        **({"faults": injected} if injected else {}),
        **mission.time_report(),
    }
