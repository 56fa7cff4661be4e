"""Metrics of missions with faults on purpose: noticed how soon, and what came of it."""

from collections.abc import Iterator

from executive.campaign.figures.metrics.report import stones
from executive.events.fault import FaultInjected, FaultShows
from executive.events.mission import Faulted, PluginFailed, VerdictGiven
from executive.events.watch import ConditionBroken, ObservationRefused, SamplesMissing
from executive.interfaces.metric import Metric, RunRecord, Share, Values
from executive.mission.report import NEAR_M

_NOTICES = (
    ObservationRefused,
    SamplesMissing,
    ConditionBroken,
    VerdictGiven,
    Faulted,
    PluginFailed,
)


class FaultsNoticed(Metric):
    """Faults on purpose that the mission has noticed."""

    title = "faults noticed"
    is_share = True
    description = (
        "Faults on purpose after whose begin an observation was refused, a sample was missing, a"
        " watched condition was broken, a monitor gave a verdict, or a plugin failed, out of all"
        " that were injected."
    )

    def measure(self, run: RunRecord) -> Share | None:
        times = list(_notice_times(run))
        return Share(sum(one is not None for one in times), len(times)) if times else None


class NoticeTime(Metric):
    """Time from a fault to its notice."""

    title = "time until a fault is noticed"
    unit = "s"
    is_more_better = False
    description = (
        "Time from the begin of each fault on purpose that was noticed to what noticed it; ticks"
        " are included. For a drive of the arm, time from when the motion that the fault keeps from"
        " it exceeds the machine's declared tracking error, and 0 if it was noticed before."
    )

    def measure(self, run: RunRecord) -> Values | None:
        found = [one for one in _notice_times(run) if one is not None]
        return Values(tuple(found)) if found else None


class FaultySuccess(Metric):
    """Missions that end in success although they should not have."""

    title = "success in spite of a fault"
    is_share = True
    is_more_better = False
    description = (
        "Runs that end in `success` although a fault on purpose was never noticed, or although by"
        f" the simulator's truth a stone is more than {NEAR_M:.2f} m off its slot, or off its pose"
        " in the database."
    )

    def measure(self, run: RunRecord) -> Share:
        if run.report.outcome != "success":
            return Share(0, 1)
        errors = [e for one in stones(run) for e in (one.slot_error_m, one.database_error_m)]
        is_off = any(error is not None and error > NEAR_M for error in errors)
        is_blind = any(one is None for one in _notice_times(run))
        return Share(int(is_off or is_blind), 1)


class Unsafe(Metric):
    """Missions in which the machine hits something or lets a stone fall."""

    title = "unsafe"
    is_share = True
    is_more_better = False
    description = (
        "Runs in which the machine collides, or a stone falls out of the jaws, by the simulator's"
        " truth; not measured on robots without truth."
    )

    def measure(self, run: RunRecord) -> Share | None:
        truth = run.report.truth
        if truth is None:
            return None
        has_dropped = any(one.dropped for one in truth.grasps or ())
        return Share(int(bool(truth.collisions) or has_dropped), 1)


def _notice_times(run: RunRecord) -> Iterator[float | None]:
    """Yield for each injected fault after how long it was noticed [s], or None.

    A fault that is hidden at first counts from when it shows.
    """
    for i, one in enumerate(run.events):
        if not isinstance(one.event, FaultInjected):
            continue
        later = run.events[i + 1 :]
        found = next((two for two in later if isinstance(two.event, _NOTICES)), None)
        if found is None:
            yield None
            continue
        shown_s = found.time_s if one.event.is_hidden else one.time_s
        for two in later:
            if isinstance(two.event, FaultShows) and two.event.number == one.event.number:
                shown_s = min(shown_s, two.time_s)
                break
        yield found.time_s - shown_s
