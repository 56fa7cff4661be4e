"""What people want of a running mission: set at any moment, followed where the loop can."""

from executive.mission.hold import Hold
from executive.mission.phase import Phase

_OPERATOR = "the operator"


class Wishes:
    """A stop, a pause, single ticks in it.

    Attributes:
        stop: The mission is to stop.
        is_orphaned: The supervisor has died; the run is to be left as after a crash.
        pause: Why it is to be held; empty while it may go on.
        steps: Ticks that it may make although it is paused.
        resumed: Why it goes on after a pause.
        pause_on_failure: It is to be held when an action fails, so that a person decides.
    """

    def __init__(self) -> None:
        self.stop = False
        self.is_orphaned = False
        self.pause = ""
        self.steps = 0
        self.resumed = ""
        self.pause_on_failure = False

    def hold(self, reason: str) -> None:
        """Want a pause."""
        self.pause, self.steps = reason, 0

    def go_on(self, by: str) -> None:
        """Want no pause any more."""
        self.pause, self.steps, self.resumed = "", 0, f"resumed by {by}"

    def toggle(self) -> None:
        """Want a pause, or no pause any more."""
        if self.pause:
            self.go_on(_OPERATOR)
        else:
            self.hold(f"paused by {_OPERATOR}")

    def step(self, ticks: int, by: str) -> None:
        """Want so many ticks, and the pause again."""
        self.steps, self.resumed = ticks, f"{ticks} {'tick' if ticks == 1 else 'ticks'} for {by}"

    def phase(self, hold: Hold | None, *, is_asking: bool) -> tuple[Phase, str]:
        """Return the phase that the mission is to be in, and why; a pause outranks the others."""
        if self.pause and not self.steps:
            return Phase.PAUSED, self.pause
        if hold is not None:
            return Phase.HELD, hold.reason
        return (Phase.AWAITING_OPERATOR if is_asking else Phase.RUNNING), ""

    def ticked(self) -> None:
        """Count a tick that the mission has made."""
        self.steps = max(self.steps - 1, 0)
