"""What metrics read from a run's report."""

from collections.abc import Mapping, Sequence
from typing import Any

from executive.interfaces.metric import RunRecord

Entries = Sequence[Mapping[str, Any]]


def truth(run: RunRecord) -> Mapping[str, Any]:
    """Return what the simulator knows; empty on a real machine, and after a fault at the start."""
    found: Mapping[str, Any] = run.report.get("truth") or {}
    return found


def stones(run: RunRecord) -> Entries:
    """Return the stones of the site by the simulator's truth; empty if there is none."""
    found: Entries = truth(run).get("stones", ())
    return found


def attempts(run: RunRecord) -> Entries:
    """Return the attempts of all relocations, in order of time."""
    tries = (one for pick in run.report["picks"] for one in pick["attempts"])
    return sorted(tries, key=lambda one: float(one["started_s"]))
