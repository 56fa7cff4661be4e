"""Leaves as nodes: an action's generator is resumed tick by tick, a condition is asked."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Any

from py_trees.common import Status

from executive.errors import ConfigError
from executive.leaf.action import Action
from executive.leaf.action import Condition as ConditionLeaf
from executive.leaf.action import Steps as LeafSteps
from executive.leaf.job import Job
from executive.leaf.memory import Recalled
from executive.leaf.outcome import Outcome, succeeded
from executive.leaf.port import written_by
from executive.leaf.runtime import MissionFaultError, Runtime
from executive.tree.leaf_use import LeafUse
from executive.tree.nodes import TreeNode
from executive.tree.orders import Order, refusal
from executive.tree.taking_up import taken_up
from executive.tree.wiring import Scope


class LeafCall:
    """One leaf at one place of the tree: its inputs are fetched, its errors are handed on.

    An error that escapes the leaf, or a plugin that it calls, goes to the runtime. It ends the
    mission there, or comes back as a failure if the mission can do without that plugin.
    """

    def __init__(self, use: LeafUse, path: str, runtime: Runtime, scope: Scope) -> None:
        self.use = use
        self.path = path
        self._make = runtime.leaf_maker(path, use.name, {**scope.uses, **use.uses})
        self.leaf = self._make(use.leaf, use.settings)
        self._runtime = runtime
        self._scope = scope
        self.parts = use.leaf.parts()
        # Most leaves ask for nothing or answer nothing more than yes or no.
        self._takes = bool(use.leaf.inputs) or use.parameters is not None
        self._gives = bool(use.leaf.outputs)
        self._is_condition = issubclass(use.leaf, ConditionLeaf)
        self.memory = runtime.memory
        if self.memory is not None:
            self.memory.attach(path, lambda state: self.leaf.restore(state))

    def within(self) -> AbstractContextManager[object]:
        """Return the context of this leaf's own code."""
        return self._runtime.within(self.path, self.use.name)

    def recalled(self) -> Recalled | None:
        """Return how this visit went in the past of a resumed mission; None in the present."""
        if self.memory is None:
            return None
        found = self.memory.recall(self.path, is_condition=self._is_condition)
        if found is not None:
            for port, value in found.written.items():
                self._scope.store.set(self.use.outputs[port].key, value)
        return found

    def kept(self, outcome: Outcome[Any]) -> Outcome[Any]:
        """Return what the leaf answered, after it was kept for resuming."""
        if self.memory is not None:
            written = written_by(outcome)
            state = self.leaf.state
            self.memory.answered(
                self.path, outcome, written, state, is_condition=self._is_condition
            )
        return outcome

    def inputs(self) -> dict[str, Any]:
        """Return the leaf's inputs by port.

        Raises:
            MissionFaultError: If a fault has ended the mission: no leaf begins any more.
            ConfigError: If a key was never written, or a computed setting is refused.
        """
        if self._runtime.is_faulted:
            raise MissionFaultError("the mission has ended in a fault")
        if not self._takes:
            return {}
        if self.use.parameters is not None:
            self.leaf = self._make(self.use.leaf, self._scope.settings(self.use))
        return self._scope.inputs(self.use)

    def written(self, outcome: object) -> Outcome[Any]:
        """Return what the leaf answered, after its outputs were written."""
        if isinstance(outcome, Outcome) and outcome.outputs is None and not self._gives:
            return outcome
        if not isinstance(outcome, Outcome):
            raise ConfigError(
                f"{self.use.name} ended with {type(outcome).__name__}, not with succeeded(…) or "
                "failed(…)"
            )
        self._scope.write(self.use, outcome)
        return outcome

    def failed(self, error: Exception) -> Outcome[Any]:
        """Hand an error to the runtime; a plugin that the mission can do without is a failure.

        Raises:
            MissionFaultError: If the mission ends for it.
        """
        return Outcome(False, self._runtime.fail(error, self.path, self.use.name))


class Asked:
    """A condition leaf that can be asked at any time."""

    def __init__(self, use: LeafUse, path: str, runtime: Runtime, scope: Scope) -> None:
        self._call = LeafCall(use, path, runtime, scope)
        self._is_condition = issubclass(use.leaf, ConditionLeaf)

    def __call__(self) -> Outcome[Any]:
        """Ask, and write the outputs."""
        with self._call.within():
            if self._call.memory is None:
                return self._answer()
            found = self._call.recalled()
            if found is not None and found.outcome is not None:
                return found.outcome
            return self._call.kept(self._answer())

    def _answer(self) -> Outcome[Any]:
        try:
            inputs = self._call.inputs()
        except ConfigError as error:
            return Outcome(False, str(error))
        try:
            leaf: Any = self._call.leaf
            if not self._is_condition:
                raise ConfigError(f"{self._call.use.name} is no condition")
            return self._call.written(leaf.check(**inputs))
        except Exception as error:  # the runtime decides what an escaped error means
            return self._call.failed(error)


class CheckNode(TreeNode):
    """A condition in the tree."""

    def __init__(
        self, name: str, path: str, runtime: Runtime, asked: Callable[[], Outcome[Any]]
    ) -> None:
        super().__init__(name, path, runtime)
        self._asked = asked

    def update(self) -> Status:
        """Ask once."""
        try:
            outcome = self._asked()
        except ConfigError as error:  # an expression that cannot be computed
            outcome = Outcome(False, str(error))
        if not outcome.success:
            self.is_refused = True
        return self.take(outcome)


class RunNode(TreeNode):
    """An action in the tree: its generator is resumed with a job's result, or at the next tick.

    When the node is cancelled, the job is given up and the generator closed, so that its `finally`
    blocks run; what the leaf drove is free for another leaf when it stands. Each round of activity
    begins a new generator.
    """

    def __init__(self, use: LeafUse, name: str, path: str, runtime: Runtime, scope: Scope) -> None:
        super().__init__(name, path, runtime)
        self._call = LeafCall(use, path, runtime, scope)
        self._is_action = issubclass(use.leaf, Action)
        self._steps: LeafSteps[Any] | None = None
        self._job: Job[Any] | None = None
        self._cut_off: dict[str, Any] | None = None  # inputs of a call that a crash has cut off
        self._order: Order | None = None
        self._failed: Outcome[Any] | None = None  # a failure that the operator decides about

    @property
    def failure(self) -> str | None:
        """Return why the leaf failed, while the operator decides about it; else None."""
        return None if self._failed is None else self._failed.reason

    def order(self, order: Order) -> str:
        """Take an order of the operator; return why it is refused, empty if it is followed."""
        refused = refusal(self._call.use, order, is_under_way=self._steps is not None)
        self._order = self._order if refused else order
        return refused

    def update(self) -> Status:
        """Go on as far as possible without waiting."""
        with self._call.within():
            return self._updated()

    def _updated(self) -> Status:
        if self._call.memory is not None:
            found = self._call.recalled()
            if found is not None:
                return self._as_before(found)
        if self._order is not None or self._failed is not None:
            decided = self._decided()
            if decided is not None:
                return self.take(self._call.kept(decided))
        if self._steps is not None and (cut_short := self.runtime.cut_short(self._call.parts)):
            self.cancel()
            return self.take(self._call.kept(Outcome(False, cut_short)))
        return self._going_on()

    def _going_on(self) -> Status:
        inputs: dict[str, Any] = {}
        if self._steps is None:
            self.feedback_message = self.runtime.still_driven(self._call.parts)
            if self.feedback_message:
                return Status.RUNNING
            try:
                inputs = self._call.inputs() if self._cut_off is None else self._cut_off
            except ConfigError as error:
                return self.take(self._call.kept(Outcome(False, str(error))))
        try:
            outcome = self._advance(inputs)
        except Exception as error:  # the runtime decides what an escaped error means
            self.cancel()
            outcome = self._call.failed(error)
        if outcome is None:
            return Status.RUNNING
        self._steps = self._job = None
        if not outcome.success and self.runtime.keeps_failed(self.path, outcome.reason):
            self._failed, self.feedback_message = outcome, f"failed: {outcome.reason}"
            return Status.RUNNING
        return self.take(self._call.kept(outcome))

    def _decided(self) -> Outcome[Any] | None:
        """Return what the operator made of the leaf; None if it begins again."""
        order, failed = self._order, self._failed
        self._order = self._failed = None
        if order is None:
            return failed
        self.cancel()
        return succeeded(reason=f"skipped by {order.by}") if order.kind == "skip" else None

    def _as_before(self, found: Recalled) -> Status:
        """Follow what was: a call that is under way at the end of the past is taken up again."""
        if found.has_begun and self._cut_off is None:
            self._cut_off = self._call.inputs()
        if found.outcome is None:
            return Status.RUNNING
        self._cut_off = None
        return self.take(found.outcome)

    def cancel(self) -> None:
        """Give up the job, and let the generator clean up."""
        with self._call.within():
            self._cancelled()

    def _cancelled(self) -> None:
        steps, job = self._steps, self._job
        self._steps = self._job = self._cut_off = self._order = self._failed = None
        try:
            try:
                if job is not None:
                    job.cancel()
            finally:
                if steps is not None:
                    steps.close()
        except Exception as error:  # an error in a `finally` block must not keep others running
            try:
                self.feedback_message = self._call.failed(error).reason
            except MissionFaultError as fault:  # the next leaf to begin ends the tick
                self.feedback_message = str(fault)
        if steps is not None:
            self.runtime.let_go(self.path, self._call.parts)

    def _advance(self, inputs: dict[str, Any]) -> Outcome[Any] | None:
        """Start or resume the generator; a job that is ready at once does not cost a tick."""
        try:
            if self._steps is None:
                self._steps = self._begun(inputs)
                self._wait_for(next(self._steps))
            elif self._job is None:
                self._wait_for(next(self._steps))
            while self._job is not None and self._job.is_ready():
                self._wait_for(self._deliver(self._steps, self._job))
        except StopIteration as end:
            return self._call.written(end.value)
        return None

    def _wait_for(self, yielded: object) -> None:
        if yielded is None:
            self._job = None
            return
        if not isinstance(yielded, Job):
            raise ConfigError(
                f"{self._call.use.name} yielded {type(yielded).__name__}; an action yields a job "
                "or None"
            )
        self._job = yielded

    def _deliver(self, steps: LeafSteps[Any], job: Job[Any]) -> object:
        self._job = None
        try:
            result = job.result()
        except Exception as error:  # raised where the leaf waits, which may handle a DataError
            return steps.throw(error)
        return steps.send(result)

    def _begun(self, inputs: dict[str, Any]) -> LeafSteps[Any]:
        leaf: Any = self._call.leaf
        if not self._is_action:
            raise ConfigError(f"{self._call.use.name} is no action")
        if self._cut_off is not None:
            self._cut_off = None
            return taken_up(leaf, inputs, self.path, self.runtime)
        if self._call.memory is not None:
            irreversible = leaf.is_irreversible
            self._call.memory.called(self.path, inputs, is_irreversible=irreversible)
        steps: LeafSteps[Any] = leaf.run(**inputs)
        if not hasattr(steps, "send"):
            raise ConfigError(f"run() of {self._call.use.name} is no generator: it needs a 'yield'")
        return steps
