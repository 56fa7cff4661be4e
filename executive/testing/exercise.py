"""What the kit asks of the plugins of one capability."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from typing import Any, ClassVar, Generic, TypeVar

from executive import registry
from executive.errors import DataError
from executive.interfaces.plugin import Plugin
from executive.machine.machine import Machine

P = TypeVar("P", bound=Plugin)


class RefusedError(Exception):
    """The plugin answered an ordinary input with a failure value; the message is its reason."""


class Exercise(ABC, Generic[P]):
    """Ordinary and hostile calls of one capability, from which the kit derives its checks.

    A package that brings a capability announces its exercise under the entry-point group
    `executive.exercise.v1`, by the capability's name; the checks of same bytes, unchanged inputs,
    time limits, hostile inputs and spawned processes then hold its plugins, too.
    """

    # Errors with which a verb may refuse a hostile input; anything else is a broken contract.
    may_raise: ClassVar[tuple[type[Exception], ...]] = (DataError,)

    @abstractmethod
    def inputs(self, machine: Machine) -> Mapping[str, Any]:
        """Return ordinary inputs, the same on each call: messages, and read-only arrays."""

    @abstractmethod
    def run(self, plugin: P, inputs: Mapping[str, Any]) -> object:
        """Call the verbs of a started plugin, and return all that they answered.

        Raises:
            RefusedError: If the plugin answers with a failure value, so that the rest of the calls
                would say nothing.
        """

    def hostile(self, machine: Machine) -> Mapping[str, Callable[[P], object]]:
        """Return calls with inputs that hold nothing useful, by a short name for each.

        Each must give a value without NaN, or raise one of `may_raise`.
        """
        return {}


def exercise_of(capability: str) -> Exercise[Any] | None:
    """Return the exercise of a capability; None where no installed package has one."""
    if capability not in registry.names(registry.EXERCISES):
        return None
    made: Exercise[Any] = registry.load(registry.EXERCISES, capability)()
    return made
