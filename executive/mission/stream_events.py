"""What the streams give rise to: verdicts, changes of status, errors of stream plugins."""

from collections.abc import Callable

from executive.events.event import Event
from executive.events.mission import (
    EstimatorStatusChanged,
    ObservationIgnored,
    VerdictGiven,
)
from executive.interfaces.plugin import Plugin
from executive.messages.status_change import StatusChange
from executive.messages.verdict import Verdict
from executive.mission.plugin_errors import PluginErrors
from executive.mission.streams import StreamListener


class StreamEvents(StreamListener):
    """Records what the streams give rise to, shows it, and keeps the verdicts for leaves."""

    def __init__(
        self,
        record: Callable[[str, Event], None],
        show: Callable[[str, object], None],
        errors: PluginErrors,
    ) -> None:
        self._record = record
        self._show = show
        self._errors = errors
        self.verdicts: list[Verdict] = []

    def take_verdict(self, verdict: Verdict) -> None:
        self.verdicts.append(verdict)
        self._show("verdict", verdict)
        self._record("", VerdictGiven(verdict.monitor, verdict.trouble, verdict.detail))

    def take_status(self, change: StatusChange) -> None:
        self._show("estimator", change)
        self._record(
            "",
            EstimatorStatusChanged(change.before, change.after, change.stamp_s, change.reason),
        )

    def take_error(self, capability: str, plugin: Plugin, error: Exception) -> None:
        """Take an error of a stream plugin: it is used no more, or ends the mission."""
        if not self._errors.excuses(self._errors.fault_of(error)):
            raise error

    def take_unknown(self, kind: str) -> None:
        self._record("", ObservationIgnored(kind))
