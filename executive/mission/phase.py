"""The state machine above the tree: which phase a mission is in, and which may follow."""

from enum import StrEnum

from executive.errors import ExecutiveError


class Phase(StrEnum):
    """Phases of a mission."""

    IDLE = "idle"
    RUNNING = "running"
    PAUSED = "paused"
    HELD = "held"  # a watched condition is broken: the machine stands until it holds again
    AWAITING_OPERATOR = "awaiting_operator"
    STOPPING = "stopping"
    DONE = "done"
    FAULTED = "faulted"


_NEXT: dict[Phase, frozenset[Phase]] = {
    Phase.IDLE: frozenset({Phase.RUNNING, Phase.FAULTED, Phase.STOPPING}),
    Phase.RUNNING: frozenset(
        {
            Phase.PAUSED,
            Phase.HELD,
            Phase.AWAITING_OPERATOR,
            Phase.STOPPING,
            Phase.DONE,
            Phase.FAULTED,
        }
    ),
    Phase.HELD: frozenset(
        {Phase.RUNNING, Phase.PAUSED, Phase.AWAITING_OPERATOR, Phase.STOPPING, Phase.FAULTED}
    ),
    Phase.PAUSED: frozenset(
        {Phase.RUNNING, Phase.HELD, Phase.AWAITING_OPERATOR, Phase.STOPPING, Phase.FAULTED}
    ),
    Phase.AWAITING_OPERATOR: frozenset(
        {
            Phase.RUNNING,
            Phase.PAUSED,
            Phase.HELD,
            Phase.STOPPING,
            Phase.DONE,
            Phase.FAULTED,
        }
    ),
    Phase.STOPPING: frozenset({Phase.DONE, Phase.FAULTED}),
    Phase.DONE: frozenset(),
    Phase.FAULTED: frozenset(),
}


class PhaseError(ExecutiveError):
    """A phase was requested that cannot follow the present one."""


def checked_change(now: Phase, then: Phase) -> Phase:
    """Return the next phase.

    Raises:
        PhaseError: If it cannot follow; the message lists those that can.
    """
    if then not in _NEXT[now]:
        allowed = ", ".join(sorted(_NEXT[now])) or "nothing"
        raise PhaseError(f"a mission that is {now} cannot become {then}; it can become {allowed}")
    return then
