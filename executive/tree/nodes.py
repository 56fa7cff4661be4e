"""The base of all nodes: a stable path, journal entries at start and end, clean cancelling.

On py_trees' Behaviour: `initialise` begins a round of activity, `terminate` ends it.
`terminate(INVALID)` also reaches nodes that ended long ago; here it does nothing unless a round is
under way.
"""

from abc import abstractmethod
from collections.abc import Generator, Iterator, Sequence
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
_RESULTS = {
    Status.SUCCESS: NodeResult.SUCCESS,
    Status.FAILURE: NodeResult.FAILURE,
    Status.INVALID: NodeResult.HALTED,
}


class TreeNode(Behaviour):  # type: ignore[misc]
    """A node of a mission's tree.

    Attributes:
        path: Where it stands, the same on every run: `main/0:ScanSwing`.
        is_repeated: Ticked anew at each tick, as the earlier children of a reactive composite are:
            then only a change of its result is journalled, not every tick.
    """

    status: Status
    is_repeated = False
    is_journalled = True  # modifiers are journalled only when they change something
    is_final = False  # the node failed for a cause that repetition cannot change

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
        status: Status = child.status
        return status

    def initialise(self) -> None:
        self._is_active = True
        self._is_told = False
        self.is_final = False
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
            self.record(NodeStarted())

    def _tell_end(self, status: Status) -> None:
        result = (status, self.feedback_message)
        if self.is_journalled and (self._is_told or result != self._last):
            self.record(NodeEnded(_RESULTS[status], self.feedback_message))
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
        if self.status is not Status.RUNNING:
            self.initialise()
        try:
            status = yield from self.proceed()
        except ConfigError as error:
            self.feedback_message = str(error)
            status = Status.FAILURE
        if status is Status.RUNNING:
            self.tell_running()
        else:
            self.stop(status)
        self.status = status
        yield self

    def stop(self, new_status: Status) -> None:
        """End; children that are running are cancelled first."""
        for child in self.children:
            stop_child(child, everything=new_status is Status.INVALID)
        super().stop(new_status)


def stop_child(child: Behaviour, *, everything: bool = False) -> None:
    """Cancel a child that runs; with `everything`, also forget how it ended."""
    if child.status is Status.RUNNING or (everything and child.status is not Status.INVALID):
        child.stop(Status.INVALID)
