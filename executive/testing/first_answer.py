"""One ordinary run of a plugin's exercise, measured: what several checks look at."""

from collections import defaultdict
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from executive.clock import wall_s
from executive.messages.parts import parts
from executive.testing.digest import content
from executive.testing.exercise import AnyExercise, RefusedError
from executive.testing.subject import Subject


@dataclass(frozen=True, slots=True)
class Answer:
    """What a plugin answered, or why it did not.

    Attributes:
        value: Everything that its verbs returned; None where it refused or failed.
        refusal: The reason of a failure value; empty if it answered.
        error: The exception that escaped; None if none did.
        longest_s: The longest call of each verb, in wall time [s].
        inputs_before: The parts of the inputs before the first call, copied.
        inputs_after: The same parts after the last call.
    """

    value: object
    refusal: str
    error: BaseException | None
    longest_s: Mapping[str, float]
    inputs_before: tuple[tuple[str, bytes], ...]
    inputs_after: tuple[tuple[str, bytes], ...]


class _Timed:
    """Hands every call on to a plugin, and keeps the longest of each verb."""

    def __init__(self, plugin: Any) -> None:
        self._plugin = plugin
        self.longest_s: dict[str, float] = defaultdict(float)

    def __getattr__(self, verb: str) -> Callable[..., Any]:
        method = getattr(self._plugin, verb)

        def call(*args: Any, **kwargs: Any) -> Any:
            began_s = wall_s()
            try:
                return method(*args, **kwargs)
            finally:
                self.longest_s[verb] = max(self.longest_s[verb], wall_s() - began_s)

        return call


def answer_of(subject: Subject, exercise: AnyExercise) -> Answer:
    """Run the exercise over a new plugin."""
    inputs = exercise.inputs(subject.machine)
    before = _content(inputs)
    value, refusal, failure = None, "", None
    longest_s: Mapping[str, float] = {}
    try:
        with subject.started() as plugin:
            timed: Any = _Timed(plugin)
            longest_s = timed.longest_s
            value = exercise.run(timed, inputs)
    except RefusedError as error:
        refusal = str(error)
    except Exception as error:  # it is reported by the check that asks whether there is an answer
        failure = error
    return Answer(value, refusal, failure, longest_s, before, _content(inputs))


def _content(inputs: Mapping[str, object]) -> tuple[tuple[str, bytes], ...]:
    return tuple((path, content(part)) for path, part in parts(inputs))
