"""Leaves as nodes: an action's generator is driven tick by tick, a condition is asked."""

from py_trees.common import Status

from executive.errors import ConfigError, ExecutiveError
from executive.leaf.action import Action
from executive.leaf.action import Condition as ConditionLeaf
from executive.leaf.action import Steps as LeafSteps
from executive.leaf.job import Job
from executive.leaf.outcome import Outcome
from executive.leaf.runtime import Runtime
from executive.tree.language import LeafUse
from executive.tree.nodes import TreeNode
from executive.tree.wiring import Scope


def reason_of(error: BaseException) -> str:
    """Say an error to a person: ours speak for themselves, others need their class."""
    return str(error) if isinstance(error, ExecutiveError) else f"{type(error).__name__}: {error}"


class Asked:
    """A condition leaf that can be asked at any time; whatever it raises is a no with a reason."""

    def __init__(self, use: LeafUse, path: str, runtime: Runtime, scope: Scope) -> None:
        self._use = use
        self._path = path
        self._runtime = runtime
        self._scope = scope
        self._leaf = use.leaf(use.settings, runtime.context(path))

    def __call__(self) -> Outcome:
        """Ask, and write the outputs."""
        try:
            if not isinstance(self._leaf, ConditionLeaf):
                raise ConfigError(f"{self._use.name} is no condition")
            outcome = self._leaf.check(**self._scope.inputs(self._use))
            return written(self._use, self._scope, outcome)
        except (
            Exception
        ) as error:  # a leaf's mistake is a failure with a reason; it never escapes into the loop
            self._runtime.fail(error, self._path)
            return Outcome(False, reason_of(error))


def written(use: LeafUse, scope: Scope, outcome: object) -> Outcome:
    """Return what a leaf answered, after its outputs were written."""
    if not isinstance(outcome, Outcome):
        raise ConfigError(
            f"{use.name} ended with {type(outcome).__name__}, not with succeeded(…) or failed(…)"
        )
    scope.write(use, outcome)
    return outcome


class CheckNode(TreeNode):
    """A condition in the tree."""

    def __init__(self, name: str, path: str, runtime: Runtime, asked: Asked) -> None:
        super().__init__(name, path, runtime)
        self._asked = asked

    def update(self) -> Status:
        """Ask once."""
        outcome = self._asked()
        self.feedback_message = outcome.reason
        return Status.SUCCESS if outcome.success else Status.FAILURE


class RunNode(TreeNode):
    """An action in the tree: its generator is resumed with a job's result, or at the next tick.

    Cancelled, the job is given up and the generator closed, so that its `finally` blocks run. Each
    round of activity begins a new generator.
    """

    def __init__(self, use: LeafUse, name: str, path: str, runtime: Runtime, scope: Scope) -> None:
        super().__init__(name, path, runtime)
        self._use = use
        self._scope = scope
        self._leaf = use.leaf(use.settings, runtime.context(path))
        self._steps: LeafSteps | None = None
        self._job: Job | None = None

    def update(self) -> Status:
        """Go on as far as possible."""
        try:
            outcome = self._advance()
        except (
            Exception
        ) as error:  # a leaf's mistake is a failure with a reason; it never escapes into the loop
            self._close()
            self.runtime.fail(error, self.path)
            outcome = Outcome(False, reason_of(error))
        if outcome is None:
            return Status.RUNNING
        self._steps = self._job = None
        self.feedback_message = outcome.reason
        return Status.SUCCESS if outcome.success else Status.FAILURE

    def cancel(self) -> None:
        """Give up the job, and let the generator clean up."""
        try:
            self._close()
        except (
            Exception
        ) as error:  # a `finally` block's mistake must not keep others from being cancelled
            self.feedback_message = reason_of(error)
            self.runtime.fail(error, self.path)

    def _close(self) -> None:
        steps, job = self._steps, self._job
        self._steps = self._job = None
        try:
            if job is not None:
                job.cancel()
        finally:
            if steps is not None:
                steps.close()

    def _advance(self) -> Outcome | None:
        """Start or resume the generator; a job that is ready at once does not cost a tick."""
        try:
            if self._steps is None:
                self._steps = self._begun()
                self._wait_for(next(self._steps))
            elif self._job is None:
                self._wait_for(next(self._steps))
            while self._job is not None and self._job.is_ready():
                self._wait_for(self._deliver(self._steps, self._job))
        except StopIteration as end:
            return written(self._use, self._scope, end.value)
        return None

    def _wait_for(self, yielded: object) -> None:
        if yielded is not None and not isinstance(yielded, Job):
            raise ConfigError(
                f"{self._use.name} yielded {type(yielded).__name__}; an action yields a job or None"
            )
        self._job = yielded

    def _deliver(self, steps: LeafSteps, job: Job) -> object:
        self._job = None
        try:
            result = job.result()
        except (
            Exception
        ) as error:  # what the plugin raised is raised where the leaf waits, which may know a cure
            return steps.throw(error)
        return steps.send(result)

    def _begun(self) -> LeafSteps:
        if not isinstance(self._leaf, Action):
            raise ConfigError(f"{self._use.name} is no action")
        steps = self._leaf.run(**self._scope.inputs(self._use))
        if not hasattr(steps, "send"):
            raise ConfigError(f"run() of {self._use.name} is no generator: it needs a 'yield'")
        return steps
