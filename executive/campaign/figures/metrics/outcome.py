"""Metrics of a mission as a whole."""

from executive.interfaces.metric import Metric, RunRecord, Share


class Success(Metric):
    """Whether the mission ended in success."""

    title = "missions that succeed"
    is_share = True
    description = (
        "Runs whose outcome is `success`, out of all runs. A run that was stopped, faulted,"
        " crashed, was killed or exceeded a limit is no success."
    )

    def measure(self, run: RunRecord) -> Share:
        return Share(int(run.report["outcome"] == "success"), 1)
