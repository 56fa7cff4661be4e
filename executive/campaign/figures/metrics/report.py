"""What metrics read from a run's report."""

from collections.abc import Sequence

from executive.interfaces.metric import RunRecord
from executive.interfaces.report import AttemptReport
from executive.interfaces.truth import TrueStone


def stones(run: RunRecord) -> Sequence[TrueStone]:
    """Return the stones of the site by the simulator's truth; empty if there is none."""
    truth = run.report.truth
    return () if truth is None else truth.stones


def attempts(run: RunRecord) -> Sequence[AttemptReport]:
    """Return the attempts of all relocations, in order of time."""
    tries = (one for pick in run.report.picks for one in pick.attempts)
    return sorted(tries, key=lambda one: one.started_s)
