"""Sequence, fallback and their reactive forms: which child is ticked when, and what that decides.

py_trees' own composites know no skipped child, forget how failed alternatives ended, and begin what
has succeeded again at each tick of a reactive composite.
"""

from abc import abstractmethod
from collections.abc import Sequence

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.leaf.runtime import Runtime
from executive.leaf.store import Store
from executive.tree.modifiers import IfNode
from executive.tree.nodes import Controller, Steps, reset_children, stop_child
from executive.tree.wiring import Scope

_SUCCESS, _FAILURE, _RUNNING = Status.SUCCESS, Status.FAILURE, Status.RUNNING


class InOrderNode(Controller):
    """One child after the other, until one ends in the way that decides.

    A child that was left out decides nothing; if all were left out, so is the node.
    """

    _decides: Status

    def __init__(
        self, name: str, path: str, runtime: Runtime, children: Sequence[Behaviour]
    ) -> None:
        super().__init__(name, path, runtime, children)
        self._next = 0
        self._last_acting: Behaviour | None = None

    def begin(self) -> None:
        self._next = 0
        self._last_acting = None
        reset_children(self)

    def proceed(self) -> Steps:
        children, decides = self.children, self._decides
        while self._next < len(children):
            child = children[self._next]
            yield from child.tick()
            status = child.status
            if status is _RUNNING:
                return status
            if not child.is_skipped:
                if status is decides:
                    return self.adopt(child)
                self._last_acting = child
            self._next += 1
        return self.adopt(self._last_acting or children[-1])


class SequenceNode(InOrderNode):
    """Children in order until one fails."""

    _decides = _FAILURE


class FallbackNode(InOrderNode):
    """Children in order until one succeeds."""

    _decides = _SUCCESS


class PersistentSequenceNode(InOrderNode):
    """A sequence that, when it is begun again after a failure or a halt, goes on where it was.

    Source: SequenceWithMemory of BehaviorTree.CPP 4.
    """

    _decides = _FAILURE

    def __init__(
        self, name: str, path: str, runtime: Runtime, children: Sequence[Behaviour], scope: Scope
    ) -> None:
        super().__init__(name, path, runtime, children)
        self._scope = scope
        self._store: Store | None = None
        self._is_resumed = False

    def begin(self) -> None:
        # The tree was called anew: the keys that the children before have written are gone.
        if self._next == len(self.children) or self._store is not self._scope.store:
            self._next = 0
            self._store = self._scope.store
        self._is_resumed = self._next > 0
        self._last_acting = None
        reset_children(self)

    def proceed(self) -> Steps:
        status = yield from super().proceed()
        if self._is_resumed:  # what was left out is the rest, not all
            self.is_skipped = False
        return status


class ReactiveNode(Controller):
    """Children in order, all asked anew at each tick, until one runs or decides."""

    _decides: Status

    def begin(self) -> None:
        reset_children(self)

    def proceed(self) -> Steps:
        decides, last, may_keep = self._decides, None, self._may_keep()
        for index, child in enumerate(self.children):
            if may_keep and self._is_kept(index, child):
                last = child
                continue
            was_running = child.status is _RUNNING
            yield from child.tick()
            status = child.status
            if status is _RUNNING:
                self._take_over(index)
                return status
            if child.is_skipped:
                continue
            if status is decides:
                return self.adopt(child)
            last = child
            if was_running:
                self._ended(child)
        return self.adopt(last or self.children[-1])

    @abstractmethod
    def _may_keep(self) -> bool:
        """Return whether there may be a child that is kept; if not, none is looked at."""

    @abstractmethod
    def _is_kept(self, index: int, child: Behaviour) -> bool:
        """Return whether a child has ended in this round and is not begun again."""

    def _take_over(self, index: int) -> None:
        """Cancel the children after the one that runs."""
        for later in self.children[index + 1 :]:
            stop_child(later)

    def _ended(self, child: Behaviour) -> None:
        """Take note of a child that has ended after some time without deciding."""


class ReactiveSequenceNode(ReactiveNode):
    """Children in order until one fails; at each tick earlier ones are asked anew.

    A child that asks no condition, such as an action, has nothing to be asked anew: once it has
    succeeded it is not begun again, until a child before it runs again or the round ends.
    """

    _decides = _FAILURE

    def __init__(
        self,
        name: str,
        path: str,
        runtime: Runtime,
        children: Sequence[Behaviour],
        asking: Sequence[bool],
    ) -> None:
        super().__init__(name, path, runtime, children)
        self._asking = tuple(asking)
        self._do_all_ask = all(asking[:-1])  # when the last has succeeded, the round is over

    def _may_keep(self) -> bool:
        return not self._do_all_ask

    def _is_kept(self, index: int, child: Behaviour) -> bool:
        return not self._asking[index] and child.status is _SUCCESS

    def _take_over(self, index: int) -> None:
        for later in self.children[index + 1 :]:
            stop_child(later, everything=True)


class ReactiveFallbackNode(ReactiveNode):
    """Children in order until one succeeds; at each tick earlier ones may take over.

    An earlier child whose action has failed after some time would be begun again and again, each
    time cancelling the alternative that its failure called for. Such a child is spent: it is not
    begun again in this round, or, behind an `if`, not before its condition has been false. A child
    that ended because a condition no longer held is not spent: it takes over again once the
    condition holds again.
    """

    _decides = _SUCCESS

    def __init__(
        self, name: str, path: str, runtime: Runtime, children: Sequence[Behaviour]
    ) -> None:
        super().__init__(name, path, runtime, children)
        self._spent: set[Behaviour] = set()

    def begin(self) -> None:
        self._spent.clear()
        super().begin()

    def _may_keep(self) -> bool:
        return bool(self._spent)

    def _is_kept(self, index: int, child: Behaviour) -> bool:
        if child in self._spent and isinstance(child, IfNode) and not child.is_open():
            self._spent.discard(child)
        return child in self._spent

    def _ended(self, child: Behaviour) -> None:
        if not child.is_refused:
            self._spent.add(child)
