"""The base of all nodes: a stable path, journal entries at start and end, clean cancelling.

On py_trees' Behaviour: `initialise` begins a round of activity, `terminate` ends it.
`terminate(INVALID)` also reaches nodes that ended long ago; here it does nothing unless a round is
under way.
"""

from abc import abstractmethod
from collections.abc import Callable, Generator, Iterator, Sequence
from typing import Any

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.errors import ConfigError
from executive.events.event import Event
from executive.events.node import NodeEnded, NodeResult, NodeStarted
from executive.leaf.outcome import Outcome
from executive.leaf.runtime import Runtime

Visits = Iterator[Behaviour]
Steps = Generator[Behaviour, None, Status]
_RUNNING, _INVALID = Status.RUNNING, Status.INVALID  # looked up at each visit of each node
_STARTED = NodeStarted()
# By the name: hashing a Status is slow.
_RESULTS = {
    "SUCCESS": NodeResult.SUCCESS,
    "FAILURE": NodeResult.FAILURE,
    "INVALID": NodeResult.HALTED,
}


class TreeNode(Behaviour):  # type: ignore[misc]
    """A node of a mission's tree.

    Attributes:
        path: Where it stands, the same on every run: `main/0:ScanSwing`.
        is_repeated: Ticked anew at each tick, as the earlier children of a reactive composite are:
            then only a change of its result is journalled, not every tick.
        is_skipped: The node was left out: its status is SUCCESS, and its parent counts it neither
            as a success nor as a failure. py_trees knows no such status.
        is_final: The node failed for a cause that repetition cannot change.
        is_refused: The node failed because a condition does not hold, and not because something
            that it did went wrong.
    """

    status: Status
    is_repeated = False
    described: Any = None  # as `tree.node_kinds` describes it; None of a modifier
    title: Callable[[], str] | None = None  # gives the name when the node begins
    is_journalled = True  # modifiers are journalled only when they change something
    is_skipped = False
    is_final = False
    is_refused = False

    def __init__(
        self, name: str, path: str, runtime: Runtime, children: Sequence[Behaviour] = ()
    ) -> None:
        Behaviour.__init__(
            self, name
        )  # not super(): a composite's own __init__ takes other arguments
        self.path = path
        self.runtime = runtime
        self._is_active = False
        self._is_told = False
        self._last: tuple[Status, str] | None = None
        for child in children:
            child.parent = self
            self.children.append(child)

    @property
    def is_under_way(self) -> bool:
        """Whether the node has begun and not ended."""
        return self._is_active

    def record(self, event: Event) -> None:
        """Append an event of this node to the journal."""
        self.runtime.record(self.path, event)

    def take(self, outcome: Outcome[Any]) -> Status:
        """Take over the reason of an outcome, and return its status."""
        self.feedback_message = outcome.reason
        self.is_final = outcome.is_final
        return Status.SUCCESS if outcome.success else Status.FAILURE

    def adopt(self, child: Behaviour) -> Status:
        """Take over a child's status and reason."""
        self.feedback_message = child.feedback_message
        self.is_final = getattr(child, "is_final", False)
        self.is_refused = getattr(child, "is_refused", False)
        self.is_skipped = getattr(child, "is_skipped", False)
        status: Status = child.status
        return status

    def tick(self) -> Visits:
        """Tick a leaf: py_trees does the same, and formats a line of debugging at each visit."""
        if self.status is not _RUNNING:
            self.initialise()
        status: Status = self.update()
        if status is _RUNNING:
            self.tell_running()
        else:  # what `stop` does, without its detours
            self._is_active = False
            self._tell_end(status)
        self.status = status
        yield self

    def stop(self, new_status: Status) -> None:
        """End the round of activity."""
        self.terminate(new_status)
        self.status = new_status

    def initialise(self) -> None:
        self._is_active = True
        self._is_told = False
        if self.title is not None:
            self.name = self.title()
        self.is_final = self.is_refused = self.is_skipped = False
        self.feedback_message = ""
        if not self.is_repeated:
            self._tell_start()
        self.begin()

    def terminate(self, new_status: Status) -> None:
        if new_status is Status.INVALID:
            self._last = None
        if not self._is_active:
            return
        self._is_active = False
        if new_status is Status.INVALID:
            self.is_skipped = False
            self.cancel()
        self._tell_end(new_status)

    def tell_running(self) -> None:
        """Journal the start of a repeated node that turns out to take time."""
        if not self._is_told:
            self._tell_start()

    def begin(self) -> None:
        """Begin a round of activity."""

    def cancel(self) -> None:
        """Clean up a round that is cut off."""

    def _tell_start(self) -> None:
        self._is_told = True
        if self.is_journalled:
            self.record(_STARTED)

    def _tell_end(self, status: Status) -> None:
        result = (status, self.feedback_message)
        if self.is_journalled and (self._is_told or result != self._last):
            ended = NodeResult.SKIPPED if self.is_skipped else _RESULTS[status.name]
            self.record(NodeEnded(ended, self.feedback_message))
        self._last = result


class Controller(TreeNode):
    """A node that decides when its children are ticked, as a generator that returns the status."""

    @abstractmethod
    def proceed(self) -> Steps:
        """Tick children by `yield from child.tick()`, and return the status."""

    def update(self) -> Status:  # pragma: no cover - `tick` is overridden
        raise NotImplementedError

    def tick(self) -> Visits:
        """Tick; a key that was never written is a failure with a reason, no escape."""
        if self.status is not _RUNNING:
            self.initialise()
        try:
            status = yield from self.proceed()
        except ConfigError as error:
            self.feedback_message = str(error)
            self.is_skipped = self.is_refused = False
            status = Status.FAILURE
        if status is _RUNNING:
            self.tell_running()
        else:
            self.stop(status)
        self.status = status
        yield self

    def stop(self, new_status: Status) -> None:
        """End; children that are running are cancelled first."""
        everything = new_status is _INVALID
        for child in self.children:
            if child.status is _RUNNING or (everything and child.status is not _INVALID):
                child.stop(_INVALID)
        super().stop(new_status)


def stop_child(child: Behaviour, *, everything: bool = False) -> None:
    """Cancel a child that runs; with `everything`, also forget how it ended."""
    if child.status is _RUNNING or (everything and child.status is not _INVALID):
        child.stop(_INVALID)


def reset_children(node: Behaviour) -> None:
    """Forget how the children of a node ended in a round before."""
    for child in node.children:
        if child.status is not _INVALID:
            child.stop(_INVALID)
