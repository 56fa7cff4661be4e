"""The status of a filter as it changes, and why it does."""

from executive_plugins.estimation.cabin.estimator import ALIGNING, INITIALISING

from executive.messages.status_change import StatusChange

GLOBAL, SUSPECT, FALLBACK = "GLOBAL", "SUSPECT", "FALLBACK"
_AGREE = "fixes agree with it again"


class StatusAccount:
    """Takes what speaks against a filter, and puts it beside the status that follows from it.

    Attributes:
        status: The newest status that was taken.
    """

    def __init__(self, changes: list[StatusChange]) -> None:
        """Begin before the first state.

        Args:
            changes: Takes each change.
        """
        self._changes = changes
        self.status = INITIALISING
        self._doubt, self._trust = "", "the first state with a heading was found"

    def doubt(self, cause: str) -> None:
        """Take why the state is in doubt from now on: the cause of the next `SUSPECT`."""
        if self.status != SUSPECT:
            self._doubt, self._trust = cause, _AGREE

    def begin_anew(self) -> None:
        """Take that the filter began anew from the fixes that it had refused."""
        self._trust = "begun anew from the fixes that were refused, which agree with one another"

    def go_back(self) -> None:
        """Take that the filter went back to what it was before fixes were in doubt."""
        self._trust = "went back to the state of before the doubt, with which fixes agree again"

    def take(self, status: str, stamp_s: float, silent_s: float) -> None:
        """Take the status of now.

        Args:
            status: The status.
            stamp_s: Time of the state [s].
            silent_s: Time since the last fix that was used [s].
        """
        if status == self.status:
            return
        reason = {
            INITIALISING: "begins anew after a gap in the inertial samples",
            ALIGNING: "the heading is not known yet",
            FALLBACK: f"no fix was used for {silent_s:.1f} s",
            SUSPECT: self._doubt,
            GLOBAL: self._trust,
        }.get(status, "")
        self._changes.append(StatusChange(stamp_s, self.status, status, reason))
        self.status, self._trust = status, _AGREE if status == FALLBACK else self._trust
