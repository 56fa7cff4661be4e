"""Metrics of lifting and holding: what happened by the truth, and what the mission noticed."""

from collections.abc import Sequence

from executive.campaign.figures.metrics.report import attempts
from executive.interfaces.metric import Metric, RunRecord, Share, Values
from executive.interfaces.truth import TrueGrasp
from executive.messages.verdict import Trouble
from executive.mission.picks import NOT_LIFTED, SHIFTED

# Each ends the attempt. A stone that falls in its trial lift is told as one that does not hang, and
# one that slips out as the jaws close, as jaws that have closed on nothing.
_NOTICED = (Trouble.DROP, Trouble.SLIP, Trouble.EMPTY, NOT_LIFTED, SHIFTED)


class Lifted(Metric):
    """Attempts that lift the stone."""

    title = "attempts that lift the stone"
    is_share = True
    description = "Attempts that lifted the stone, by the simulator's truth, out of all attempts."

    def measure(self, run: RunRecord) -> Share | None:
        told = _told(run)
        return Share(sum(grasp.lifted for _, grasp in told), len(told)) if told else None


class Held(Metric):
    """Lifted stones that do not fall."""

    title = "lifted stones held to the end"
    is_share = True
    description = (
        "Attempts whose stone did not fall out of the jaws, by the simulator's truth, out of those"
        " that lifted it."
    )

    def measure(self, run: RunRecord) -> Share | None:
        lifted = [grasp for _, grasp in _told(run) or () if grasp.lifted]
        return Share(sum(not grasp.dropped for grasp in lifted), len(lifted)) if lifted else None


class DropsFound(Metric):
    """Drops that the mission noticed."""

    title = "drops found"
    is_share = True
    description = (
        "Attempts that the mission ended with the outcome `drop`, `slip`, `empty`, `not lifted` or"
        " `shifted`, out of those whose stone fell by the simulator's truth."
    )

    def measure(self, run: RunRecord) -> Share | None:
        told = _told(run)
        if told is None:
            return None
        dropped = [outcome for outcome, grasp in told if grasp.dropped]
        return Share(sum(outcome in _NOTICED for outcome in dropped), len(dropped))


class DropsMissed(Metric):
    """Drops that the mission did not notice."""

    title = "drops missed"
    is_more_better = False
    description = (
        "Number of attempts in a run whose stone fell by the simulator's truth, and which the"
        " mission ended with another outcome than `drop`, `slip`, `empty`, `not lifted` or"
        " `shifted`."
    )

    def measure(self, run: RunRecord) -> Values | None:
        told = _told(run)
        if told is None:
            return None
        missed = (grasp.dropped and outcome not in _NOTICED for outcome, grasp in told)
        return Values((sum(missed),))


class FalseAlarms(Metric):
    """Reported drops of stones that did not fall."""

    title = "false alarms"
    is_share = True
    is_more_better = False
    description = (
        "Attempts that the mission ended with the outcome `drop`, out of those whose stone did not"
        " fall by the simulator's truth."
    )

    def measure(self, run: RunRecord) -> Share | None:
        told = _told(run)
        if told is None:
            return None
        kept = [outcome for outcome, grasp in told if not grasp.dropped]
        return Share(sum(outcome == Trouble.DROP for outcome in kept), len(kept))


class Slips(Metric):
    """Slips that the mission noticed."""

    title = "slips noticed"
    is_more_better = False
    description = (
        "Number of slips that monitors reported in a run. The mission sets such a stone down where"
        " it is and tries again."
    )

    def measure(self, run: RunRecord) -> Values:
        return Values((run.report.counts.slips,))


def _told(run: RunRecord) -> Sequence[tuple[str, TrueGrasp]] | None:
    """Return each attempt's outcome by the mission, and what the truth says of it.

    None if the truth does not tell.
    """
    truth = run.report.truth
    if truth is None or truth.grasps is None:
        return None
    outcomes = [one.outcome for one in attempts(run)]
    return list(zip(outcomes, truth.grasps, strict=True))
