"""A figure that a mission reports by the leaf ReportFigure, as a metric: `figure.NAME`."""

from executive.interfaces.metric import Metric, RunRecord, Values

PREFIX = "figure."


class Figure(Metric):
    """The newest figure of a name in each run; larger counts as better."""

    def __init__(self, name: str) -> None:
        """Measure the figure of a name."""
        self._name = name
        self.title = f"figure {name}"  # type: ignore[misc]  # its own, not the class's
        self.description = f"What the mission reported as '{name}'."  # type: ignore[misc]

    def measure(self, run: RunRecord) -> Values | None:
        found = run.report.figures.get(self._name)
        return None if found is None else Values((float(found.value),))
