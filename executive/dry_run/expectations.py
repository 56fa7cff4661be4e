"""What a dry run is expected to show, and where it did something else."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from executive.dry_run.dry_run import DryResult
from executive.errors import ConfigError
from executive.events.event import plain
from executive.tree.expressions.evaluation import evaluate
from executive.tree.key_source import Computed, Literally, Ref, Source
from executive.tree.problem import Mark

_TOLERANCE = 1e-9  # relative: of a quantity that was given in another unit


@dataclass(frozen=True, slots=True)
class ExpectedNodes:
    """Nodes that are expected to be ticked or not, or to end in some ways.

    Attributes:
        name: What the file calls them.
        paths: Their paths.
        mark: Where the file says it.
        ends: How they end, in order; empty if only ticking counts.
    """

    name: str
    paths: tuple[str, ...]
    mark: Mark
    ends: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ExpectedKey:
    """A key of `main` and its value at the end."""

    key: str
    source: Source
    mark: Mark


@dataclass(frozen=True, slots=True)
class Expectations:
    """What a file expects of a dry run.

    Attributes:
        outcome: `success` or `failure`, with its place.
        within_s: The longest mission time [s], with its place.
        visited: Nodes that are ticked.
        not_visited: Nodes that are not.
        ends: Nodes that end in some ways, in order.
        keys: Keys and their values.
        that: Expressions that hold at the end.
    """

    outcome: tuple[str, Mark] | None = None
    within_s: tuple[float, Mark] | None = None
    visited: Sequence[ExpectedNodes] = ()
    not_visited: Sequence[ExpectedNodes] = ()
    ends: Sequence[ExpectedNodes] = ()
    keys: Sequence[ExpectedKey] = ()
    that: Sequence[Ref | Computed] = field(default=())

    @property
    def count(self) -> int:
        """Return the number of expectations."""
        alone = sum(one is not None for one in (self.outcome, self.within_s))
        many = (self.visited, self.not_visited, self.ends, self.keys, self.that)
        return alone + sum(len(one) for one in many)

    def broken_by(self, result: DryResult) -> list[str]:
        """Return what a run did otherwise, each with its place in the file."""
        return [f"{mark}: {told}" for mark, told in self._broken(result)]

    def _broken(self, result: DryResult) -> Iterator[tuple[Mark, str]]:
        if self.outcome is not None and result.outcome != self.outcome[0]:
            reason = f": {result.reason}" if result.reason else ""
            told = f"expected {self.outcome[0]}, and it ended in {result.outcome}{reason}"
            yield self.outcome[1], told
        if self.within_s is not None and result.ended_s > self.within_s[0] + _TOLERANCE:
            told = f"expected an end within {self.within_s[0]:g} s, and it took"
            yield self.within_s[1], f"{told} {result.ended_s:g} s"
        ticked = {*result.tally.ticked, *(path for path, _ in result.ends)}
        for one in self.visited:
            if not ticked & {*one.paths}:
                yield one.mark, f"'{one.name}' was expected to be ticked, and was not"
        for one in self.not_visited:
            for path in sorted(ticked & {*one.paths}):
                yield one.mark, f"'{one.name}' was not expected to be ticked, and {path} was"
        for one in self.ends:
            found = tuple(end for path, end in result.ends if path in one.paths)
            if found != one.ends:
                got = ", ".join(found) or "it never ended"
                yield one.mark, f"'{one.name}' was expected to end {', '.join(one.ends)}; got {got}"
        yield from self._broken_keys(result)

    def _broken_keys(self, result: DryResult) -> Iterator[tuple[Mark, str]]:
        for one in self.keys:
            if one.key not in result.store:
                yield one.mark, f"key '{one.key}' was expected, and was never written"
                continue
            got, wanted = result.store.get(one.key), _value(one.source, result)
            if not _is_equal(got, wanted):
                yield one.mark, f"key '{one.key}' was expected to be {wanted!r}, and is {got!r}"
        for that in self.that:
            try:
                holds = _value(that, result)
            except ConfigError as error:
                yield that.mark, str(error)
                continue
            if holds is not True:
                text = f"{{{that.key}}}" if isinstance(that, Ref) else str(that)
                yield that.mark, f"'{text}' was expected to hold, and is {holds!r}"


def _value(source: Source, result: DryResult) -> Any:
    match source:
        case Literally(value=value):
            return value
        case Ref(key=key):
            return result.store.get(key)
        case Computed(expression=expression):
            return evaluate(expression, result.store)
    return None


def _is_equal(got: Any, wanted: Any) -> bool:
    """Compare plain values; numbers with a relative tolerance."""
    got = plain(got)
    if isinstance(got, Mapping) and isinstance(wanted, Mapping):
        same = got.keys() == wanted.keys()
        return same and all(_is_equal(got[key], wanted[key]) for key in got)
    if isinstance(got, list) and isinstance(wanted, list):
        return len(got) == len(wanted) and all(map(_is_equal, got, wanted))
    numbers = all(isinstance(x, int | float) and not isinstance(x, bool) for x in (got, wanted))
    return bool(np.isclose(got, wanted, rtol=_TOLERANCE, atol=0.0)) if numbers else got == wanted
