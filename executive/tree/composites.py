"""Sequence and fallback on py_trees' Sequence and Selector; a parallel of its own."""

from collections.abc import Sequence

from py_trees import composites
from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.leaf.runtime import Runtime
from executive.tree.modifiers import IfNode
from executive.tree.nodes import Controller, Steps, TreeNode, Visits, stop_child


class _Journalled(TreeNode):
    """Ticks as a py_trees composite, and is journalled with the deciding child's reason."""

    children: list[Behaviour]
    current_child: Behaviour | None = None

    def tick(self) -> Visits:
        """Tick as py_trees does."""
        yield from super().tick()
        if self.status is Status.RUNNING:
            self.tell_running()

    def terminate(self, new_status: Status) -> None:
        """End a round."""
        decisive = self.decisive(new_status) if new_status is not Status.INVALID else None
        if decisive is not None:
            self.adopt(decisive)
        super().terminate(new_status)

    def decisive(self, status: Status) -> Behaviour | None:
        """Return the child that settled the status."""
        raise NotImplementedError


class SequenceNode(_Journalled, composites.Sequence):  # type: ignore[misc]
    """Children in order until one fails; reactive, earlier ones are ticked again at each tick."""

    def __init__(
        self, name: str, path: str, runtime: Runtime, children: Sequence[Behaviour], *, memory: bool
    ) -> None:
        TreeNode.__init__(self, name, path, runtime, children)
        self.memory = memory

    def decisive(self, status: Status) -> Behaviour | None:
        return self.children[-1] if status is Status.SUCCESS else self.current_child


class FallbackNode(_Journalled, composites.Selector):  # type: ignore[misc]
    """Children in order until one succeeds."""

    memory = True

    def begin(self) -> None:
        for child in (
            self.children
        ):  # py_trees' Sequence forgets how a former round ended, its Selector does not
            stop_child(child, everything=True)

    def decisive(self, status: Status) -> Behaviour | None:
        return self.current_child if status is Status.SUCCESS else self.children[-1]


class ReactiveFallbackNode(Controller):
    """Children in order until one succeeds; at each tick earlier ones may take over.

    py_trees' Selector without memory would begin an earlier child that has failed after some time
    again and again, each time cancelling the alternative that its failure called for. Here such a
    child is spent: it is not begun again, or, behind an `if`, not before its condition has been
    false.
    """

    def __init__(
        self, name: str, path: str, runtime: Runtime, children: Sequence[Behaviour]
    ) -> None:
        super().__init__(name, path, runtime, children)
        self._spent: set[Behaviour] = set()

    def begin(self) -> None:
        self._spent.clear()
        for child in self.children:
            stop_child(child, everything=True)

    def proceed(self) -> Steps:
        for index, child in enumerate(self.children):
            if self._is_spent(child):
                continue
            was_running = child.status is Status.RUNNING
            yield from child.tick()
            status = self.adopt(child)
            if status is not Status.FAILURE:
                for later in self.children[index + 1 :]:
                    stop_child(later)
                return status
            if was_running:
                self._spent.add(child)
        return Status.FAILURE

    def _is_spent(self, child: Behaviour) -> bool:
        if child in self._spent and isinstance(child, IfNode) and not child.is_open():
            self._spent.discard(child)
        return child in self._spent


class ParallelNode(Controller):
    """All children at once; ends when enough have succeeded, or too many have failed.

    py_trees' Parallel knows "all" and "one", fails at the first failure, and ticks ended children
    anew.
    """

    def __init__(
        self, name: str, path: str, runtime: Runtime, children: Sequence[Behaviour], succeed: int
    ) -> None:
        super().__init__(name, path, runtime, children)
        self._succeed = succeed

    def begin(self) -> None:
        for child in self.children:
            stop_child(child, everything=True)

    def proceed(self) -> Steps:
        for child in self.children:
            if child.status in (Status.INVALID, Status.RUNNING):
                yield from child.tick()
        failed = [child for child in self.children if child.status is Status.FAILURE]
        succeeded = [child for child in self.children if child.status is Status.SUCCESS]
        if len(succeeded) >= self._succeed:
            return Status.SUCCESS
        if len(self.children) - len(failed) < self._succeed:
            return self.adopt(failed[-1])
        return Status.RUNNING
