"""Nodes that change how their one child's end counts: not, force_failure."""

from py_trees.common import Status

from executive.tree.nodes import Controller, Steps


class NotNode(Controller):
    """Turns success into failure, and failure into success; a child left out stays left out."""

    def proceed(self) -> Steps:
        child = self.children[0]
        was_running = child.status is Status.RUNNING
        yield from child.tick()
        status = self.adopt(child)
        if status is Status.RUNNING or self.is_skipped:
            return status
        self.is_final = False
        # A check that succeeds at once is a condition that does not hold; an action is not.
        self.is_refused = status is Status.SUCCESS and not was_running
        return Status.FAILURE if status is Status.SUCCESS else Status.SUCCESS


class ForceFailureNode(Controller):
    """Fails whatever its child returns; a child left out stays left out."""

    def proceed(self) -> Steps:
        child = self.children[0]
        yield from child.tick()
        status = self.adopt(child)
        return status if status is Status.RUNNING or self.is_skipped else Status.FAILURE
