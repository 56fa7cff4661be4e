"""A verb that is called within the tick; its answer is checked as that of a job is."""

from collections.abc import Callable, Sequence
from typing import Any

from executive.interfaces.plugin import Plugin
from executive.interfaces.robot import Robot
from executive.messages.observation import Observation
from executive.mission.jobs.answer import unfit
from executive.mission.jobs.call import WrongAnswerError
from executive.mission.jobs.notes import address_of, loop_in_verb


def asked(verb: Callable[..., Any], *args: object) -> Any:
    """Call a method of a plugin and return its answer.

    A verb that takes an observation and answers with something else than its interface says has
    not taken it, and nothing else would tell before the estimate is too old.

    Raises:
        WrongAnswerError: If the answer is of another type than the interface says, or holds a NaN.
    """
    plugin = _owner(verb)
    if plugin is None:
        return verb(*args)
    with loop_in_verb(plugin, verb.__name__):
        answer = verb(*args)
    if reason := unfit(plugin, verb.__name__, answer):
        raise _error(plugin, verb.__name__, reason)
    return answer


def observations_of(robot: Robot, until_s: float) -> Sequence[Observation]:
    """Read a robot up to a machine time [s].

    What single observations hold is up to the guard, which refuses those that cannot be true.

    Raises:
        WrongAnswerError: If the robot returns no sequence.
    """
    with loop_in_verb(robot, "read"):
        found = robot.read(until_s)
    if not isinstance(found, Sequence):
        raise _error(robot, "read", f"{type(found).__name__} instead of a sequence of observations")
    return found


def _owner(verb: Callable[..., Any]) -> Plugin | None:
    owner = getattr(verb, "__self__", None)
    return owner if isinstance(owner, Plugin) else None


def _error(plugin: Plugin, verb: str, reason: str) -> WrongAnswerError:
    return address_of(plugin, verb).error(WrongAnswerError, f"it returned {reason}")
