"""What the kit asks of the plugins of one capability."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from typing import ClassVar, Generic, TypeAlias

from typing_extensions import TypeVar

from executive import registry
from executive.errors import DataError
from executive.interfaces.plugin import Plugin
from executive.machine.machine import Machine

P = TypeVar("P", bound=Plugin)
I = TypeVar("I", bound=Mapping[str, object], default=Mapping[str, object])  # noqa: E741


class RefusedError(Exception):
    """The plugin answered an ordinary input with a failure value; the message is its reason."""


class Exercise(ABC, Generic[P, I]):
    """Ordinary and hostile calls of one capability, from which the kit derives its checks.

    A package that brings a capability announces its exercise under the entry-point group
    `executive.exercise.v1`, by the capability's name; the checks of same bytes, unchanged inputs,
    time limits, hostile inputs and spawned processes then hold its plugins, too. The interface
    stands in brackets, and after it a `TypedDict` of the inputs, so that mypy checks their use:
    `class AlignmentExercise(Exercise[Aligner, AlignmentInputs])`.
    """

    # Errors with which a verb may refuse a hostile input; anything else is a broken contract.
    may_raise: ClassVar[tuple[type[Exception], ...]] = (DataError,)

    @abstractmethod
    def inputs(self, machine: Machine) -> I:
        """Return ordinary inputs, the same on each call: messages, and read-only arrays."""

    @abstractmethod
    def run(self, plugin: P, inputs: I) -> object:
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


AnyExercise: TypeAlias = Exercise[Plugin, Mapping[str, object]]


def exercise_of(capability: str) -> AnyExercise | None:
    """Return the exercise of a capability; None where no installed package has one."""
    if capability not in registry.names(registry.EXERCISES):
        return None
    made: AnyExercise = registry.load(registry.EXERCISES, capability)()
    return made
