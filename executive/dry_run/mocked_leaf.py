"""What stands in the place of a leaf in a dry run: it ends as a file says, or as chance has it."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, make_dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from executive.dry_run.chance import Chance
from executive.dry_run.made_up import Maker
from executive.dry_run.script import MockedOutcome, MockedStatus, Outcomes
from executive.leaf.action import Leaf, Steps
from executive.leaf.outcome import Outcome
from executive.leaf.runtime import Runtime

EPSILON_S = 1e-9  # the clock is a product of ticks, and a duration need not be


@dataclass(slots=True)
class Mocking:
    """What the mocked leaves of one run share.

    Attributes:
        runtime: The run.
        chance: The probabilities of what no file says.
        tell: Takes an output or a field that was made up, by its name.
        limits_s: The shortest `timeout` around each action that has one [s], by path.
    """

    runtime: Runtime
    chance: Chance
    tell: Callable[[str, Any], None]
    limits_s: Mapping[str, float] = field(default_factory=dict)


class MockedLeaf:
    """An action or a condition at one place of the tree; it has the ports of the real one."""

    def __init__(
        self, kind: type[Leaf[Any]], path: str, mocking: Mocking, outcomes: Outcomes | None
    ) -> None:
        self._kind, self._path, self._mocking, self._outcomes = kind, path, mocking, outcomes
        seed = [mocking.chance.seed, *path.encode()]
        self._rng = np.random.default_rng(seed)
        self._maker = Maker(self._rng, mocking.tell)
        self._drawn = MockedOutcome()  # the present answer of a condition that no file mocks
        self._holds_until_s = -np.inf
        self._answered: tuple[MockedOutcome, Outcome[Any]] | None = None

    def run(self, **inputs: Any) -> Steps[Any]:
        """Take so long, and end as an action does."""
        runtime = self._mocking.runtime
        mocked = self._draw_action() if self._outcomes is None else self._outcomes.take()
        end_s = runtime.clock.now_s() + (mocked.after_s or 0.0)
        runtime.due(end_s)
        while mocked.status is MockedStatus.RUNNING or runtime.clock.now_s() < end_s - EPSILON_S:
            yield None
        return self._outcome(mocked)

    def check(self, **inputs: Any) -> Outcome[Any]:
        """Answer as a condition does."""
        runtime = self._mocking.runtime
        now_s = runtime.clock.now_s()
        if self._outcomes is not None:
            mocked, due_s = self._outcomes.answer(now_s, EPSILON_S)
            if due_s is not None:
                runtime.due(due_s)
            return self._answer(mocked)
        if now_s >= self._holds_until_s - EPSILON_S:
            holds = self._mocking.chance.holds(self._rng)
            self._drawn = _drawn(holds)
            self._holds_until_s = now_s + self._mocking.chance.duration_s(self._rng)
        runtime.due(self._holds_until_s)
        return self._answer(self._drawn)

    def _answer(self, mocked: MockedOutcome) -> Outcome[Any]:
        """Return a condition's answer; what is made up stays the same while the answer holds."""
        if self._answered is None or self._answered[0] is not mocked:
            self._answered = (mocked, self._outcome(mocked))
        return self._answered[1]

    def _draw_action(self) -> MockedOutcome:
        chance, rng = self._mocking.chance, self._rng
        limit_s = self._mocking.limits_s.get(self._path)
        is_failure = chance.fails(rng)
        duration_s = chance.duration_s(rng, math.inf if limit_s is None else limit_s)
        if is_failure and limit_s is not None and chance.hangs(rng):
            return MockedOutcome(MockedStatus.RUNNING)
        return _drawn(not is_failure, duration_s)

    def _outcome(self, mocked: MockedOutcome) -> Outcome[Any]:
        success = mocked.status is MockedStatus.SUCCESS
        values = {port: recipe(self._maker) for port, recipe in mocked.outputs.items()}
        if success:
            for port, spec in self._kind.outputs.items():
                if port not in values:
                    values[port] = self._maker.make(spec.type, port, spec.doc)
                    self._mocking.tell(port, values[port])
        drawn = "the seed" if self._outcomes is None else "the file of mocks"
        reason = mocked.reason or (
            "" if success else f"{self._kind.__name__} fails, as {drawn} has it"
        )
        return Outcome(success, reason, _result(values) if values else None, mocked.is_final)


def _drawn(success: bool, after_s: float | None = None) -> MockedOutcome:
    if success:
        return MockedOutcome(after_s=after_s)
    return MockedOutcome(MockedStatus.FAILURE, after_s)


def _result(values: Mapping[str, Any]) -> Any:
    """Return values as the result of a leaf, whose fields are its output ports."""
    return _result_class(tuple(values))(**values)


@lru_cache(maxsize=1024)
def _result_class(ports: tuple[str, ...]) -> Any:
    return make_dataclass("Mocked", ports, frozen=True)
