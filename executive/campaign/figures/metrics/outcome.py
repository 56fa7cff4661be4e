"""Metrics of a mission as a whole."""

from executive.interfaces.metric import Metric, RunRecord, Share, Values


class Success(Metric):
    """Whether the mission ended in success."""

    title = "missions that succeed"
    is_share = True
    description = (
        "Runs whose outcome is `success`, out of all runs. A run that was stopped, faulted,"
        " crashed, was killed or exceeded a limit is no success."
    )

    def measure(self, run: RunRecord) -> Share:
        return Share(int(run.report.outcome == "success"), 1)


class Collisions(Metric):
    """Contacts that should not be."""

    title = "collisions"
    is_more_better = False
    description = (
        "Number of contacts of the machine in a run, by the simulator's truth, except those of"
        " gripper and jaws with the ground and with the stone that they are to grasp."
    )

    def measure(self, run: RunRecord) -> Values | None:
        truth = run.report.truth
        if truth is None or truth.collisions is None:
            return None
        return Values((len(truth.collisions),))


class PluginFailures(Metric):
    """Errors of plugins that a mission went on after."""

    title = "errors of plugins passed over"
    is_more_better = False
    description = (
        "Number of errors in a run that plugins raised which were selected with `on_error: fail`,"
        " so that the mission went on."
    )

    def measure(self, run: RunRecord) -> Values:
        return Values((run.report.counts.plugin_failures,))
