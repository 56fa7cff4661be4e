"""Report a number."""

from pydantic import Field

from executive.config import Settings
from executive.events.finding import FigureReported
from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, succeeded

FIGURE_NAME = r"^[A-Za-z][A-Za-z0-9_]{0,59}$"
LARGEST = 1e15  # whole numbers up to here are exact: a float64 holds all of them up to 2^53


class ReportFigureSettings(Settings):
    name: str = Field(
        pattern=FIGURE_NAME,
        examples=["stones_found"],
        description="Name in the report: letters, digits and underscores.",
    )
    value: float = Field(
        ge=-LARGEST,
        le=LARGEST,
        examples=["{count}", 3.0],
        description="The number; it is written as it is given.",
    )
    unit: str = Field(
        "", max_length=20, description="Its unit, for people: quantities on keys are in SI units."
    )


class ReportFigure(Condition[ReportFigureSettings]):
    """Write a number into journal and report, where a campaign finds it as `figure.NAME`."""

    on_resume = OnResume.REDO

    def check(self) -> Outcome[None]:
        """Record it; a later figure of the same name replaces it in the report."""
        wanted = self.settings
        self.context.record(FigureReported(wanted.name, wanted.value, wanted.unit))
        return succeeded(reason=f"{wanted.name} = {wanted.value:g} {wanted.unit}".rstrip())
