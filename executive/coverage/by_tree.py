"""Coverage by the trees of a mission: what several calls of one tree have taken counts together."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from typing import TypeVar

from executive.coverage.branch import Branch, Limb
from executive.coverage.coverage import Coverage, Tally

Key = TypeVar("Key")


def by_tree(coverage: Coverage) -> Coverage:
    """Return the coverage of each tree once, wherever it is called.

    A path then begins with the name of its tree: `move_stone/0:sequence`.
    """
    calls = {limb.path: limb for limb in coverage.limbs if limb.calls}
    trees: dict[str, dict[str, Limb]] = {}
    for limb in coverage.limbs:
        call = _call_around(limb.path, calls)
        one = _moved(limb, call)
        of_tree = trees.setdefault(call.calls if call else "main", {})
        known = of_tree.get(one.path)
        of_tree[one.path] = one if known is None else _joined(known, one)
    limbs = [limb for of_tree in trees.values() for limb in of_tree.values()]
    return Coverage(coverage.mission, limbs, coverage.runs, _tally(coverage.tally, calls))


def _call_around(path: str, calls: dict[str, Limb]) -> Limb | None:
    """Return the innermost call that a path lies below."""
    parts = path.split("/")
    ends = (calls.get("/".join(parts[:count])) for count in range(len(parts) - 1, 0, -1))
    return next((call for call in ends if call is not None), None)


def _path(path: str, call: Limb | None) -> str:
    return path if call is None else f"{call.calls}{path.removeprefix(call.path)}"


def _moved(limb: Limb, call: Limb | None) -> Limb:
    if call is None:
        return limb
    depth = limb.depth - call.depth - 1
    path = _path(limb.path, call)
    branches = tuple(Branch(_path(one.path, call), one.what) for one in limb.branches)
    return replace(
        limb, path=path, name=limb.name if depth else path, depth=depth, branches=branches
    )


def _joined(one: Limb, other: Limb) -> Limb:
    """Return a node with the branches that it has at either place."""
    return replace(one, branches=tuple(dict.fromkeys((*one.branches, *other.branches))))


def _tally(tally: Tally, calls: dict[str, Limb]) -> Tally:
    merged = Tally()
    merged.taken = _counted(
        (Branch(_path(one.path, _call_around(one.path, calls)), one.what), count)
        for one, count in tally.taken.items()
    )
    merged.ticked = _counted(
        (_path(path, _call_around(path, calls)), count) for path, count in tally.ticked.items()
    )
    return merged


def _counted(many: Iterable[tuple[Key, int]]) -> Counter[Key]:
    found: Counter[Key] = Counter()
    for key, count in many:
        found[key] += count
    return found
