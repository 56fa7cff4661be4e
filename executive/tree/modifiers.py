"""Modifiers of a node: if, while, timeout, retry, on_failure, optional; all on mission time."""

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.events.node import (
    NodeExcused,
    NodeForbidden,
    NodeLeftOut,
    NodeNotRetried,
    NodeRetried,
    NodeTimedOut,
)
from executive.leaf.runtime import Runtime
from executive.tree.conditions import Answer
from executive.tree.language import Attempts
from executive.tree.nodes import Controller, Steps

EPSILON_S = 1e-9  # the clock is a product of ticks, and a duration need not be


class Modifier(Controller):
    """Around one child; it is journalled only when it changes something."""

    is_journalled = False

    def __init__(self, name: str, path: str, runtime: Runtime, child: Behaviour) -> None:
        super().__init__(name, path, runtime, [child])
        self.child = child


class IfNode(Modifier):
    """Ticks its child if a condition holds when it begins, and is left out otherwise.

    Left out means success in a sequence, which goes on; in a fallback it means failure, so that the
    next alternative is tried.
    """

    def __init__(
        self,
        name: str,
        path: str,
        runtime: Runtime,
        child: Behaviour,
        answer: Answer,
        left_out: Status,
    ) -> None:
        super().__init__(name, path, runtime, child)
        self._answer = answer
        self._left_out = left_out

    def is_open(self) -> bool:
        """Ask the condition."""
        return self._answer().success

    def proceed(self) -> Steps:
        if self.child.status is not Status.RUNNING:
            answer = self._answer()
            if not answer.success:
                self.feedback_message = (
                    f"left out: {answer.reason}" if answer.reason else "left out"
                )
                if not self.is_repeated:
                    self.record(NodeLeftOut(answer.reason))
                return self._left_out
        yield from self.child.tick()
        return self.adopt(self.child)


class WhileNode(Modifier):
    """Checks a condition before every tick of its child, and cancels it when it no longer holds."""

    def __init__(
        self, name: str, path: str, runtime: Runtime, child: Behaviour, answer: Answer
    ) -> None:
        super().__init__(name, path, runtime, child)
        self._answer = answer

    def proceed(self) -> Steps:
        answer = self._answer()
        if not answer.success:
            self.feedback_message = (
                f"no longer allowed: {answer.reason}" if answer.reason else "no longer allowed"
            )
            if not self.is_repeated:
                self.record(NodeForbidden(answer.reason))
            return Status.FAILURE
        yield from self.child.tick()
        return self.adopt(self.child)


class TimeoutNode(Modifier):
    """Cancels its child when it has taken too long by the mission's clock: a failure."""

    def __init__(
        self, name: str, path: str, runtime: Runtime, child: Behaviour, limit_s: float
    ) -> None:
        super().__init__(name, path, runtime, child)
        self._limit_s = limit_s
        self._started_s = 0.0

    def begin(self) -> None:
        self._started_s = self.runtime.clock.now_s()

    def proceed(self) -> Steps:
        yield from self.child.tick()
        if self.child.status is not Status.RUNNING:
            return self.adopt(self.child)
        if self.runtime.clock.now_s() - self._started_s < self._limit_s - EPSILON_S:
            return self.adopt(self.child)
        self.feedback_message = f"not done within {self._limit_s:g} s"
        self.record(NodeTimedOut(self._limit_s))
        return Status.FAILURE


class RetryNode(Modifier):
    """Begins its child again when it fails, at the next tick or after a pause.

    It makes so many attempts in all, and none more after a failure whose cause cannot change, such
    as a stone that is too heavy.
    """

    def __init__(
        self, name: str, path: str, runtime: Runtime, child: Behaviour, attempts: Attempts
    ) -> None:
        super().__init__(name, path, runtime, child)
        self._attempts = attempts
        self._attempt = 1
        self._resume_s = 0.0

    def begin(self) -> None:
        self._attempt = 1
        self._resume_s = 0.0

    def proceed(self) -> Steps:
        if self.runtime.clock.now_s() < self._resume_s - EPSILON_S:
            return Status.RUNNING
        yield from self.child.tick()
        reason = self.child.feedback_message
        if self.child.status is not Status.FAILURE:
            of = f"attempt {self._attempt} of {self._attempts.count}"
            self.feedback_message = (
                f"{of}{f': {reason}' if reason else ''}" if self._attempt > 1 else reason
            )
            return self._child_status()
        if getattr(self.child, "is_final", False) and self._attempt < self._attempts.count:
            self.record(NodeNotRetried(self._attempt, self._attempts.count, reason))
            return self.adopt(self.child)
        if self._attempt >= self._attempts.count:
            self.feedback_message = f"{reason or 'failed'} ({self._attempts.count} attempts)"
            return Status.FAILURE
        self.record(NodeRetried(self._attempt, self._attempts.count, reason))
        self._attempt += 1
        self._resume_s = self.runtime.clock.now_s() + self._attempts.pause_s
        self.feedback_message = f"attempt {self._attempt} of {self._attempts.count} after: {reason}"
        return Status.RUNNING

    def _child_status(self) -> Status:
        status: Status = self.child.status
        return status


class OnFailureNode(Controller):
    """Ticks a recovery when its child has failed; the node fails whatever the recovery returns."""

    is_journalled = False

    def __init__(
        self, name: str, path: str, runtime: Runtime, child: Behaviour, recovery: Behaviour
    ) -> None:
        super().__init__(name, path, runtime, [child, recovery])
        self._child = child
        self._recovery = recovery
        self._is_recovering = False

    def begin(self) -> None:
        self._is_recovering = False

    def proceed(self) -> Steps:
        if not self._is_recovering:
            yield from self._child.tick()
            status = self.adopt(self._child)
            if status is not Status.FAILURE:
                return status
            self._is_recovering = True
        yield from self._recovery.tick()
        reason = self._child.feedback_message
        if self._recovery.status is Status.RUNNING:
            self.feedback_message = f"recovering from: {reason}"
            return Status.RUNNING
        failed = self._recovery.status is Status.FAILURE
        self.feedback_message = (
            f"{reason}; recovery failed: {self._recovery.feedback_message}" if failed else reason
        )
        return Status.FAILURE


class OptionalNode(Modifier):
    """Turns its child's failure into success."""

    def proceed(self) -> Steps:
        yield from self.child.tick()
        status = self.adopt(self.child)
        if status is not Status.FAILURE:
            return status
        if not self.is_repeated:
            self.record(NodeExcused(self.feedback_message))
        return Status.SUCCESS
