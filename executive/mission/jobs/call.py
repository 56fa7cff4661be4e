"""One call of a plugin's verb, and the errors of a call that came to no answer."""

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from executive.errors import RobotError
from executive.events.mission import Fault
from executive.interfaces.plugin import Plugin
from executive.mission.fault import REMOTE, shown

Failure = TypeVar("Failure", bound="CallError")


class CallError(RobotError):
    """A verb came to no answer, for a reason that is no exception of the plugin."""


class WorkerDiedError(CallError):
    """The process that computed a verb ended in the middle of the call."""


class VerbOverdueError(CallError):
    """A verb computed for longer than its limit."""


class VerbExitedError(CallError):
    """A verb called `sys.exit`."""


class NotPortableError(CallError):
    """An argument or an answer cannot be sent between processes."""


class WrongAnswerError(CallError):
    """A verb returned something else than its interface says."""


@dataclass(frozen=True, slots=True)
class VerbCall:
    """One call of a plugin's verb: its name and arguments."""

    verb: str
    args: Sequence[Any]
    kwargs: Mapping[str, Any]

    def of(self, plugin: Plugin) -> Any:
        """Call the verb of a plugin.

        Raises:
            VerbExitedError: If the verb calls `sys.exit`, which must not end the mission.
        """
        try:
            return getattr(plugin, self.verb)(*self.args, **self.kwargs)
        except SystemExit as error:
            exited = VerbExitedError(f"it called sys.exit({error.code!r})")
            raise exited.with_traceback(error.__traceback__) from error


@dataclass(frozen=True, slots=True)
class FunctionCall(VerbCall):
    """One call of a leaf's own function, which belongs to no plugin."""

    function: Callable[..., Any]

    def of(self, plugin: Plugin) -> Any:
        """Call the function."""
        return self.function(*self.args, **self.kwargs)


@dataclass(frozen=True, slots=True)
class Address:
    """Whose verb it is, as messages name it; picklable.

    Attributes:
        capability: Capability of the plugin; empty for a leaf's own function.
        name: Name of the plugin, as installed.
        verb: The verb, or the function.
        place: `file:line` where the verb is defined.
    """

    capability: str
    name: str
    verb: str
    place: str

    @classmethod
    def of(cls, capability: str, name: str, plugin: Plugin, verb: str) -> "Address":
        """Return the address of a verb of a plugin."""
        return cls(capability, name, verb, place_of_verb(plugin, verb))

    @classmethod
    def of_function(cls, function: Callable[..., Any]) -> "Address":
        """Return the address of a leaf's own function."""
        return cls("", "", function.__name__, _place_of(function))

    @property
    def component(self) -> str:
        """The plugin, or the function, for a person."""
        return f"{self.capability} plugin '{self.name}'" if self.capability else "a leaf's function"

    def error(self, kind: type[Failure], reason: str, place: str = "", trace: str = "") -> Failure:
        """Return an error whose fault names the plugin, the verb, and the place in its code.

        Args:
            kind: Class of the error.
            reason: What happened, for a person.
            place: `file:line` where it happened; where that is unknown, the verb's definition.
            trace: The call stack as text, if it is known.
        """
        owner = f"the {self.component}" if self.capability else "a leaf"
        error = kind(f"'{self.verb}' of {owner}: {reason}")
        fault = Fault(
            component=self.component,
            capability=self.capability,
            name=self.name,
            verb=self.verb,
            node="",
            error=f"{kind.__name__}: {reason}",
            place=place or self.place,
            traceback=trace or str(error),
        )
        setattr(error, REMOTE, fault)
        return error


def place_of_verb(plugin: Plugin, verb: str) -> str:
    """Return `file:line` where a verb of a plugin is defined; empty if it is not in Python."""
    return _place_of(getattr(type(plugin), verb, None))


def _place_of(function: Any) -> str:
    code = getattr(inspect.unwrap(function) if function else None, "__code__", None)
    return "" if code is None else f"{shown(code.co_filename)}:{code.co_firstlineno}"
