"""Conditions at run time: `"{key}"`, checks, and their not, all and any."""

from collections.abc import Callable
from typing import Any

from executive.errors import ConfigError
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.runtime import Runtime
from executive.tree.expressions.evaluation import evaluate, values_in
from executive.tree.key_source import Computed
from executive.tree.leaf_nodes import Asked
from executive.tree.leaf_use import Combined, Condition, KeyHolds, LeafUse
from executive.tree.wiring import Scope

Answer = Callable[[], Outcome[Any]]


def build_condition(condition: Condition, path: str, runtime: Runtime, scope: Scope) -> Answer:
    """Return a function that answers a condition; its leaves' paths begin with `path`."""
    if isinstance(condition, LeafUse):
        return Asked(condition, f"{path}:{condition.name}", runtime, scope)
    if isinstance(condition, KeyHolds):
        return lambda: _holds(condition, scope)
    if isinstance(condition, Computed):
        return lambda: _is_true(condition, scope)
    parts = [
        build_condition(part, f"{path}/{index}", runtime, scope)
        for index, part in enumerate(condition.parts)
    ]
    combine = {"not": _not, "all": _all, "any": _any}[condition.how]
    return lambda: combine(parts)


def condition_text(condition: Condition) -> str:
    """Return a condition as a person reads it."""
    if isinstance(condition, LeafUse):
        return condition.name
    if isinstance(condition, KeyHolds):
        return f"{{{condition.key}}}"
    if isinstance(condition, Computed):
        return str(condition)
    return _combined_text(condition)


def _combined_text(condition: Combined) -> str:
    parts = [condition_text(part) for part in condition.parts]
    if condition.how == "not":
        return f"not {parts[0]}"
    return "(" + {"all": " and ", "any": " or "}[condition.how].join(parts) + ")"


def _holds(condition: KeyHolds, scope: Scope) -> Outcome[Any]:
    if scope.store.get(condition.key) is True:
        return succeeded(reason=f"{condition.key} is true")
    return failed(f"{condition.key} is not true")


def _is_true(condition: Computed, scope: Scope) -> Outcome[Any]:
    """Compute a condition; the reason names the values that it was computed from.

    Raises:
        ConfigError: If it cannot be computed, or is neither true nor false.
    """
    value = evaluate(condition.expression, scope.store)
    if not isinstance(value, bool):
        raise ConfigError(f"a condition needs true or false, and '{condition}' is {value!r}")
    values = values_in(condition.expression, scope.store)
    told = f"{condition} is {str(value).lower()}{f' ({values})' if values else ''}"
    return succeeded(reason=told) if value else failed(told)


def _not(parts: list[Answer]) -> Outcome[Any]:
    answer = parts[0]()
    return Outcome(not answer.success, answer.reason)


def _all(parts: list[Answer]) -> Outcome[Any]:
    answers: list[Outcome[Any]] = []
    for part in parts:
        answers.append(part())
        if not answers[-1].success:
            return answers[-1]
    return succeeded(reason="; ".join(a.reason for a in answers if a.reason))


def _any(parts: list[Answer]) -> Outcome[Any]:
    answers: list[Outcome[Any]] = []
    for part in parts:
        answers.append(part())
        if answers[-1].success:
            return answers[-1]
    return failed("; ".join(a.reason for a in answers if a.reason))
