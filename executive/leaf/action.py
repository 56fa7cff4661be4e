"""The two kinds of leaves: actions, which take time, and conditions, which do not."""

from abc import ABC, abstractmethod
from collections.abc import Generator, Mapping
from typing import Any, ClassVar

from executive.config import NoSettings, Settings
from executive.leaf.context import Context
from executive.leaf.job import Job
from executive.leaf.outcome import Outcome
from executive.leaf.port import Port

# An action yields a job to be resumed with its result, or None to be resumed at the next tick.
Steps = Generator[Job | None, Any, Outcome]


class Leaf:
    """What actions and conditions share; found under the entry-point group
    `executive.behaviour.v1`.
    """

    Settings: ClassVar[type[Settings]] = NoSettings
    inputs: ClassVar[Mapping[str, Port]] = {}
    outputs: ClassVar[Mapping[str, Port]] = {}
    needs: ClassVar[tuple[str, ...]] = ()  # capabilities that the leaf calls

    def __init__(self, settings: Any, context: Context) -> None:
        self.settings = settings
        self.context = context


class Action(Leaf, ABC):
    """A leaf that takes time, told as a generator: it yields where it waits; a `finally` cleans up
    when cancelled.
    """

    @abstractmethod
    def run(self, **inputs: Any) -> Steps:
        """Do it; keyword arguments are the input ports by name."""


class Condition(Leaf, ABC):
    """A leaf that answers at once."""

    @abstractmethod
    def check(self, **inputs: Any) -> Outcome:
        """Answer; keyword arguments are the input ports by name."""
