"""Modifiers of a node: if, once, while, timeout, retry, on_failure, optional, on_halt.

All times are mission time.
"""

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
from executive.leaf.runtime import MissionFaultError, Runtime
from executive.tree.conditions import Answer
from executive.tree.node_kinds import Attempts
from executive.tree.nodes import Controller, Steps
from executive.tree.rounds import Rounds

EPSILON_S = 1e-9  # the clock is a product of ticks, and a duration need not be


class Modifier(Controller):
    """Around one child; it is journalled only when it changes something."""

    is_journalled = False

    def __init__(self, name: str, path: str, runtime: Runtime, child: Behaviour) -> None:
        super().__init__(name, path, runtime, [child])
        self.child = child


class IfNode(Modifier):
    """Ticks its child if a condition holds when it begins, and is left out otherwise.

    A node that is left out is no success and no failure: a sequence and a fallback go on to the
    next child, and a node whose children were all left out is left out itself.
    """

    def __init__(
        self, name: str, path: str, runtime: Runtime, child: Behaviour, answer: Answer
    ) -> None:
        super().__init__(name, path, runtime, child)
        self._answer = answer

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
                self.is_skipped = self.is_refused = True
                return Status.SUCCESS
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
            self.is_refused = True
            return Status.FAILURE
        yield from self.child.tick()
        return self.adopt(self.child)


class TimeoutNode(Modifier):
    """Cancels its child when it has taken too long by the mission's clock: a failure.

    The child is not ticked any more at the tick at which its time is over.
    """

    def __init__(
        self, name: str, path: str, runtime: Runtime, child: Behaviour, limit_s: float
    ) -> None:
        super().__init__(name, path, runtime, child)
        self.limit_s = limit_s
        self._started_s = 0.0

    def begin(self) -> None:
        self._started_s = self.runtime.limited_time_s()
        self.runtime.due(self.runtime.clock.now_s() + self.limit_s)

    def proceed(self) -> Steps:
        took_s = self.runtime.limited_time_s() - self._started_s
        if self.child.status is Status.RUNNING and took_s >= self.limit_s - EPSILON_S:
            self.feedback_message = f"not done within {self.limit_s:g} s"
            self.record(NodeTimedOut(self.limit_s))
            return Status.FAILURE
        yield from self.child.tick()
        return self.adopt(self.child)


class RetryNode(Modifier):
    """Begins its child again when it fails.

    An attempt that failed within one tick is followed by the next at once; after one that took time
    the next begins at the next tick, or after the pause. It makes so many attempts in all, and none
    more after a failure whose cause cannot change, such as a stone that is too heavy.
    """

    def __init__(
        self,
        name: str,
        path: str,
        runtime: Runtime,
        child: Behaviour,
        attempts: Attempts,
        rounds: Rounds,
    ) -> None:
        super().__init__(name, path, runtime, child)
        self._attempts = attempts
        self._rounds = rounds
        self._attempt = 1
        self._resume_s = 0.0

    def begin(self) -> None:
        self._attempt = 1
        self._resume_s = 0.0

    def proceed(self) -> Steps:
        if self.runtime.clock.now_s() < self._resume_s - EPSILON_S:
            return Status.RUNNING
        with self._rounds.tick():
            while self.child.status is Status.RUNNING or self._rounds.take():
                was_running = self.child.status is Status.RUNNING
                yield from self.child.tick()
                status = self._judged()
                if status is not Status.RUNNING:
                    return status
                is_pausing = self._attempts.pause_s > 0.0
                if was_running or is_pausing or self.child.status is Status.RUNNING:
                    break
        if self.child.status is not Status.RUNNING:
            self.runtime.due(self._resume_s)
        return Status.RUNNING

    def _judged(self) -> Status:
        """Return the node's status after a visit of its child."""
        reason, of = self.child.feedback_message, self._attempts.count
        if self.child.status is not Status.FAILURE:
            status = self.adopt(self.child)
            if self._attempt > 1:
                number = f"attempt {self._attempt} of {of}"
                self.feedback_message = f"{number}{f': {reason}' if reason else ''}"
            return status
        if self.child.is_final and self._attempt < of:
            self.record(NodeNotRetried(self._attempt, of, reason))
            return self.adopt(self.child)
        if self._attempt >= of:
            self.is_refused = self.child.is_refused
            self.feedback_message = f"{reason or 'failed'} ({of} attempts)"
            return Status.FAILURE
        self.record(NodeRetried(self._attempt, of, reason))
        self._attempt += 1
        self._resume_s = self.runtime.clock.now_s() + self._attempts.pause_s
        self.feedback_message = f"attempt {self._attempt} of {of} after: {reason}"
        return Status.RUNNING


class OnFailureNode(Controller):
    """Ticks a recovery when its child has failed; the node fails whatever the recovery returns.

    Beside `retry` it prepares the next attempt, and so it is left out after a failure that is final
    and has none.
    """

    is_journalled = False

    def __init__(
        self,
        name: str,
        path: str,
        runtime: Runtime,
        child: Behaviour,
        recovery: Behaviour,
        *,
        is_retried: bool,
    ) -> None:
        super().__init__(name, path, runtime, [child, recovery])
        self._child = child
        self._recovery = recovery
        self._is_retried = is_retried
        self._is_recovering = False

    def begin(self) -> None:
        self._is_recovering = False

    def proceed(self) -> Steps:
        if not self._is_recovering:
            yield from self._child.tick()
            status = self.adopt(self._child)
            if status is not Status.FAILURE or (self._is_retried and self.is_final):
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
        self.is_final = self.is_refused = False
        return Status.SUCCESS


class OnceNode(Modifier):
    """Ticks its child to its end once in a mission, and leaves it out afterwards.

    A child that was halted or left out before its end begins again. Source: RunOnce of
    BehaviorTree.CPP 4, `then_skip`.
    """

    _has_ended = False

    def proceed(self) -> Steps:
        if self._has_ended:
            self.feedback_message = "left out: it has run before"
            self.is_skipped = True
            return Status.SUCCESS
        yield from self.child.tick()
        status = self.adopt(self.child)
        self._has_ended = status is not Status.RUNNING and not self.is_skipped
        return status


class OnHaltNode(Controller):
    """Ticks a node of one tick when its child is cancelled, after the child has cleaned up."""

    is_journalled = False

    def __init__(
        self, name: str, path: str, runtime: Runtime, child: Behaviour, cleanup: Behaviour
    ) -> None:
        super().__init__(name, path, runtime, [child, cleanup])
        self._child = child
        self._cleanup = cleanup

    def proceed(self) -> Steps:
        yield from self._child.tick()
        return self.adopt(self._child)

    def cancel(self) -> None:
        if self.runtime.is_faulted:  # no leaf begins after a fault
            return
        try:
            self._cleanup.tick_once()
        except MissionFaultError as fault:  # the next leaf to begin ends the tick
            self.feedback_message = str(fault)
        self._cleanup.stop(Status.INVALID)
