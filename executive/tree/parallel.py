"""Several children at once: `parallel`, which ends when enough have succeeded or failed."""

from collections.abc import Sequence

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.leaf.runtime import Runtime
from executive.tree.node_kinds import Parallel
from executive.tree.nodes import Controller, Steps, reset_children


class ParallelNode(Controller):
    """All children at once; ends as soon as the result is certain, and cancels the others.

    The result is certain when enough children have succeeded, when too many have failed, or when
    too few are left to succeed. It is looked for after each child, so that no child begins after
    it. With `wait_for_all` every child is ticked to its end first.

    A child that was left out counts as neither; `succeed: all` means all others.

    py_trees' Parallel knows "all" and "one", fails at the first failure, and ticks ended children
    anew.
    """

    def __init__(
        self, name: str, path: str, runtime: Runtime, children: Sequence[Behaviour], kind: Parallel
    ) -> None:
        super().__init__(name, path, runtime, children)
        self._kind = kind
        self._open: list[Behaviour] = []
        self._succeeded = 0
        self._failed = 0
        self._last_failed: Behaviour | None = None

    @property
    def thresholds(self) -> tuple[int, int]:
        """Return how many children must succeed, and how many failures make it fail."""
        return self._kind.succeed, self._kind.fail

    def begin(self) -> None:
        reset_children(self)
        self._open = list(self.children)
        self._succeeded = self._failed = 0
        self._last_failed = None

    def proceed(self) -> Steps:
        running: list[Behaviour] = []
        total = len(self._open)
        for number, child in enumerate(self._open, 1):
            yield from child.tick()
            if child.status is Status.RUNNING:
                running.append(child)
                continue
            self._count(child)
            if not self._kind.wait_for_all:
                status = self._result(len(running) + total - number)
                if status is not Status.RUNNING:
                    return status
        self._open = running
        return Status.RUNNING if running else self._result(0)

    def _count(self, child: Behaviour) -> None:
        if child.is_skipped:
            return
        if child.status is Status.SUCCESS:
            self._succeeded += 1
        else:
            self._failed += 1
            self._last_failed = child

    def _result(self, under_way: int) -> Status:
        """Return the result, or RUNNING while it is open; `under_way` have not ended yet."""
        kind = self._kind
        counted = self._succeeded + self._failed + under_way
        if counted == 0:
            self.feedback_message, self.is_skipped = "all children were left out", True
            return Status.SUCCESS
        needed = counted if kind.needs_all else kind.succeed
        if self._last_failed is not None and self._failed >= kind.fail:
            return self.adopt(self._last_failed)
        if self._succeeded >= needed:
            return Status.SUCCESS
        if self._succeeded + under_way >= needed:
            return Status.RUNNING
        if self._last_failed is not None:
            return self.adopt(self._last_failed)
        self.feedback_message = (
            f"{len(self.children) - counted} children were left out, and {needed} are to succeed"
        )
        return Status.FAILURE
