"""What leaves answered: kept while a mission goes on, and given back when it is resumed."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum

from executive.leaf.outcome import Outcome


class OnResume(StrEnum):
    """What becomes of a leaf that was under way when its run was cut off.

    REDO begins it again. VERIFY runs its `verify`, which looks how far the work is and does the
    rest. ASK asks the operator whether it is done, to be redone, or failed. FAIL lets it fail, so
    that the tree's own recovery goes on.
    """

    REDO = "redo"
    VERIFY = "verify"
    ASK = "ask"
    FAIL = "fail"


@dataclass(frozen=True, slots=True)
class Recalled:
    """How a visit of a leaf went when the mission was first there.

    Attributes:
        outcome: What the leaf answered, outputs left out; None if it was still under way.
        written: Values of its outputs by port.
        has_begun: The leaf was begun in this visit or taken up again.
    """

    outcome: Outcome[object] | None
    written: Mapping[str, object]
    has_begun: bool


class Memory(ABC):
    """One mission's memory of its leaves, by node.

    In the past of a resumed mission, `recall` gives back what was; after that it gives None, and
    the leaves are asked themselves.
    """

    @abstractmethod
    def recall(self, node: str, *, is_condition: bool) -> Recalled | None:
        """Return how this visit of a leaf went; None in the present. Asked at each visit."""

    @abstractmethod
    def called(self, node: str, inputs: Mapping[str, object], *, is_irreversible: bool) -> None:
        """Keep that a leaf is to begin; an irreversible one, on the disk before this returns."""

    @abstractmethod
    def taken_up(self, node: str, policy: OnResume) -> None:
        """Keep that a leaf that was cut off is taken up again."""

    @abstractmethod
    def answered(
        self,
        node: str,
        outcome: Outcome[object],
        written: Mapping[str, object],
        state: Mapping[str, object],
        *,
        is_condition: bool,
    ) -> None:
        """Keep what a leaf answered, with its own state; a condition's answer if it changed."""

    @abstractmethod
    def attach(self, node: str, restore: Callable[[Mapping[str, object]], None]) -> None:
        """Name what takes back the state of a leaf."""
