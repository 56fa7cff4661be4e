"""Metrics of durations on the mission's clock."""

from executive.interfaces.metric import Metric, RunRecord, Values


class CycleTime(Metric):
    """Duration of each relocation."""

    title = "cycle time"
    unit = "s"
    is_more_better = False
    description = (
        "Mission time from the choice of the first grasp for a stone to its release at a slot, with"
        " all attempts in between, for each relocation that ended in a release."
    )

    def measure(self, run: RunRecord) -> Values | None:
        placed = [pick["attempts"] for pick in run.report["picks"] if pick["placed"]]
        return Values(tuple(tries[-1]["ended_s"] - tries[0]["started_s"] for tries in placed))
